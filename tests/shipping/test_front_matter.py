"""Tests that a hardened folder's README is a model card that Hugging Face's library can read."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest
from huggingface_hub import ModelCard

from mitigate.evaluation.rows import gather
from mitigate.shipping.card import front_matter, readme

ROOT = Path(__file__).parents[2]
SHIPPED = sorted((ROOT / "checkpoints/hardened").glob("[!.]*"))


def card_of(folder: Path) -> dict:
    return json.loads((folder / "card.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("folder", SHIPPED, ids=lambda folder: folder.name)
def test_shipped_folder_is_a_model_repository(folder):
    card, loaded = card_of(folder), ModelCard.load(folder / "README.md")
    data = loaded.data
    assert (data.library_name, data.license, data.pipeline_tag) == (
        "mitigate",
        "apache-2.0",
        "robotics",
    )
    assert card["recipe"].replace("_", "-") in data.tags and data.model_name == card["name"]
    (entry,) = card["metrics"]
    results = {result.metric_name: result for result in data.eval_results}
    assert len(results) == 2 + len(entry["PRS"]) + len(entry["SR"])
    for title, (value, low, high) in entry["PRS"].items():
        assert results[title].metric_value == value
        assert results[title].metric_args["interval"] == [low, high]
    clean = results["Clean SR"]
    assert clean.metric_value == entry["clean"]["SR"][0] and clean.dataset_split == "val_unseen"
    assert clean.dataset_args["episodes"] in (100, 300) and clean.metric_args["level"] == 0.95
    assert loaded.text.strip().startswith(f"# {card['name']}")
    path = f"checkpoints/hardened/{folder.name}"
    assert (folder / "README.md").read_text(encoding="utf-8") == readme(card, path)


@pytest.mark.parametrize("folder", SHIPPED, ids=lambda folder: folder.name)
def test_published_rows_match_a_shipped_card(folder):
    column = {"harden": "harden_2"}.get(folder.name, folder.name)
    published = gather([ROOT / f"docs/results/second/{column}-val_unseen.jsonl.gz"])
    (agent,) = card_of(folder)["rows_agent"]
    assert len({row["corruption"] for row in published if row["agent"] == agent}) == 13


def test_card_without_metrics_or_with_odd_names_is_valid():
    card = card_of(SHIPPED[0]) | {"metrics": []}
    assert ModelCard(front_matter(card)).data.eval_results is None
    strange = 'a: [b\n---\n"x": !!python/object:os.system'
    own_value = card_of(SHIPPED[0])
    own_value["name"] = strange
    own_value["metrics"][0] |= {
        "rule": strange,
        "split": strange,
        "PRS": {"PRS-SR (RGB)": [None] * 3},
    }
    data = ModelCard(front_matter(own_value)).data
    assert data.model_name == strange and data.eval_results[0].dataset_split == strange
    assert "PRS-SR (RGB)" not in {result.metric_name for result in data.eval_results}


@pytest.mark.parametrize("name", ["on", "null", "2.0"])
def test_text_stays_one_string_for_current_yaml_readers(name):
    card = card_of(SHIPPED[0]) | {"name": name, "recipe": name}
    text = front_matter(card)
    assert f"name: '{name}'\n" in text and ModelCard(text).data.model_name == name


@pytest.mark.parametrize("path", ["checkpoints/topological_imagenet", 'my "own"/Größe\\agent'])
def test_readme_shows_the_path_of_the_folder(path):
    text = readme(card_of(SHIPPED[0]), path)
    (line,) = (line for line in text.splitlines() if line.startswith("agent = "))
    (argument,) = ast.parse(line).body[0].value.args
    assert argument.value == path
    assert "checkpoints/hardened" not in text.partition("## Use")[2]


def test_page_shows_words_of_rows_unchanged():
    card = card_of(SHIPPED[0])
    card["metrics"][0]["suite"] = "1.1 <script>alert(1)</script> `x`"
    text = ModelCard(readme(card, "checkpoints/hardened/mine")).text
    assert r"suite 1.1 \<script>alert(1)\</script> \`x\`." in text
