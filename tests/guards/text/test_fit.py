"""Fitting the rules prints; only when asked does it replace the weights that are shipped."""

import json

from mitigate.guards.text import fit
from mitigate.guards.text.texts import weights


def test_only_write_replaces_the_weights(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(weights, "FILE", tmp_path / "weights.json")
    monkeypatch.setattr(fit, "style_words", lambda: ["kindly", "stroll"])
    fitted = {"own": {"bias": -2.5, "text": 1.2503}}
    table = {"the_door": -0.75, "ignore": 1.5}
    monkeypatch.setattr(fit, "fit_weights", lambda split: (fitted, table))
    fit.main([])
    printed = capsys.readouterr().out
    assert not weights.FILE.exists()
    fit.main(["--write"])
    assert weights.FILE.read_text(encoding="utf-8") == printed
    made = json.loads(printed)
    assert made["own"] == {"bias": -2.5, "text": 1.25} and made["style"] == ["kindly", "stroll"]
    assert list(made["words"].items()) == [("ignore", 1.5), ("the_door", -0.75)]


def test_only_the_front_is_fitted_when_asked(tmp_path, monkeypatch):
    file = tmp_path / "weights.json"
    file.write_text(weights.FILE.read_text(encoding="utf-8"))
    before = json.loads(file.read_text())
    monkeypatch.setattr(weights, "FILE", file)
    monkeypatch.setattr(fit, "examples", lambda split: [])
    monkeypatch.setattr(fit, "front_weights", lambda found: {"bias": 1.0})
    fit.main(["--front", "--write"])
    assert json.loads(file.read_text()) == {**before, "front": {"bias": 1.0}}
