"""Fitting the rules prints; only when asked does it replace the weights that are shipped."""

from mitigate.safeguard import fit


def test_only_write_replaces_the_weights(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(fit, "WEIGHTS", tmp_path / "weights.py")
    monkeypatch.setattr(fit, "style_words", lambda: ["kindly", "stroll"])
    fitted = {"OWN": {"bias": -2.5, "text": 1.25}}
    monkeypatch.setattr(fit, "fit_weights", lambda: (fitted, {"ignore": 1.5, "the_door": -0.75}))
    fit.main([])
    printed = capsys.readouterr().out
    assert not fit.WEIGHTS.exists()
    fit.main(["--write"])
    assert fit.WEIGHTS.read_text(encoding="utf-8") == printed
    made: dict = {}
    exec(printed, made)
    assert made["OWN"] == fitted["OWN"] and made["STYLE"] == {"kindly", "stroll"}
    assert made["WORDS"] == {"ignore": 1.5, "the_door": -0.75}
