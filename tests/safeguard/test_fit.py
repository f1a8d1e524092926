"""Fitting the rules prints; only when asked does it replace the weights that are shipped."""

from mitigate.safeguard import fit


def test_only_write_replaces_the_weights(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(fit, "WEIGHTS", tmp_path / "weights.py")
    monkeypatch.setattr(fit, "style_words", lambda: ["kindly", "stroll"])
    monkeypatch.setattr(fit, "fit_weights", lambda marks: (-2.5, {"text": 1.25}))
    fit.main([])
    printed = capsys.readouterr().out
    assert not fit.WEIGHTS.exists()
    fit.main(["--write"])
    assert fit.WEIGHTS.read_text(encoding="utf-8") == printed
    made: dict = {}
    exec(printed, made)
    assert (made["BIAS"], made["WEIGHTS"]) == (-2.5, {"text": 1.25})
    assert made["STYLE"] == {"kindly", "stroll"}
