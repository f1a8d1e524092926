"""The vision-language agent asks a pretrained image-text-to-text model for its next answer.

The logits of a decision are the log-likelihoods of the allowed answers, so every objective that
trains on decisions (imitation, distillation, self-distillation) also trains this agent. Only LoRA
weights are trained. ``save`` writes the LoRA weights as a PEFT folder, which other programs can
load.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.checkpoint import checkpoint

from mitigate.agents.agent import Output, check_logits, stop_figures
from mitigate.agents.vlm.answers import Answer
from mitigate.agents.vlm.conversation import SYSTEM, AnsweringAgent, Memory, views_of
from mitigate.agents.vlm.rollout import (
    AnswerDecisions,
    Piece,
    join_pieces,
    piece_of,
    run_episode,
)
from mitigate.core import folders
from mitigate.core.checkpoint import load_tensors
from mitigate.core.files import write_json
from mitigate.core.json_files import read_object
from mitigate.core.names import unknown
from mitigate.core.pretrained import (
    LORA,
    PEFT_WEIGHTS,
    PRECISIONS,
    TEMPLATE_DATE,
    check_place,
    explained,
    files_sha256,
    keep_lora_only,
    load_network,
    local_folder,
)
from mitigate.core.progress import Progress, say
from mitigate.worlds.episodes import Episode
from mitigate.worlds.world import World

INSTALL = "pip install -e '.[train,vlm]'"
CONFIG, BASE = "adapter_config.json", "base.json"  # files of a saved agent, next to its weights
# maximum number of decisions in a training rollout (heuristic), as for the recurrent agent
LIMIT = 90
ALL_LINEAR = "all-linear"  # PEFT's name for all linear modules, instead of a list


class VLMAgent(AnsweringAgent, nn.Module):
    """Choose the most likely of the allowed answers with a vision-language model.

    The model sees the instruction, earlier frames and the current view. It never generates text: it
    scores each allowed answer, so every decision is an allowed answer.

    Args:
        model: folder or hub id of a model for ``AutoModelForImageTextToText`` with its processor.
        precision: precision of the frozen weights, one of ``PRECISIONS`` ("int8" and "nf4" need
            bitsandbytes).
        lora: ``r``, ``alpha``, ``dropout``, and names of linear modules: ``language`` lists modules
            of the language model, and ``vision`` lists modules of the image encoder and the
            projector. Instead of a list, "all-linear" selects all of them. If None, no LoRA is
            added.
        answers, history, task, system_prompt: see ``AnsweringAgent``.
        images: keyword arguments of the image processor, such as ``{"max_pixels": 100352}``.
        checkpointing: whether the backward pass computes each decision a second time, so that
            memory holds the activations of only one decision.
        adapters: must be None; recipes that insert adapters into encoders do not fit this agent.

    Raises:
        ValueError: If a setting is invalid, a package is missing, or the model cannot be loaded.
        FileNotFoundError: If the folder of the model does not exist.
    """

    frozen = ("network",)
    own_config_only = ("model",)
    brings_weights = True
    base_sha256: Tensor  # uint8 [32], the sha256 of the model's weights
    _answer_ids: Tensor  # [n, L]
    _is_answer: Tensor  # bool [n, L]

    def __init__(
        self,
        model: str | None = None,
        precision: str = "fp32",
        lora: Mapping[str, Any] | None = None,
        answers: str = "navid",
        history: int = 4,
        task: str | None = None,
        system_prompt: str | None = SYSTEM,
        images: Mapping[str, Any] | None = None,
        checkpointing: bool = True,
        adapters: Any = None,
    ) -> None:
        super().__init__()
        if adapters:
            raise ValueError(
                "A vision-language agent trains LoRA weights (agent.lora) instead of adapters, so "
                "recipe=harden, conv_adapter and stacked do not fit. Choose recipe=harden_vlm "
                "(docs/vlm.md)."
            )
        if not model:
            raise ValueError(
                "agent.model must be the folder or hub id of a vision-language model, such as "
                "Qwen/Qwen2.5-VL-3B-Instruct (docs/vlm.md)."
            )
        self.prepare(answers, history, task, system_prompt)
        if precision not in PRECISIONS:
            raise ValueError(unknown("precision (agent.precision)", precision, PRECISIONS))
        self._settings |= {
            "precision": precision,
            "lora": copy.deepcopy(dict(lora)) if lora else None,
            "images": dict(images) if images else None,
        }
        self.model = model
        self.images = dict(images or {})
        self.checkpointing = checkpointing
        check_place(model, "a vision-language model: agent.model=FOLDER")
        with explained(model, precision, INSTALL), Progress(f"loading {model}", 1) as progress:
            from transformers import AutoModelForImageTextToText

            folder = local_folder(model)
            self.processor = load_processor(folder)
            network: Any = load_network(AutoModelForImageTextToText, folder, precision)
            progress.advance()
        sha = torch.tensor(list(bytes.fromhex(files_sha256(folder))), dtype=torch.uint8)
        # the sha256 is stored as a buffer, so that the fingerprint includes it
        self.register_buffer("base_sha256", sha)
        network.requires_grad_(False)
        self.network: Any = _with_lora(network, lora) if lora else network
        keep_lora_only(self)
        self._read_template()

    def settings(self) -> dict[str, Any]:
        """Return the constructor's arguments that determine the answers, except ``model``.

        ``base_sha256`` identifies the model.
        """
        return dict(self._settings)

    @property
    def device(self) -> torch.device:
        return self.network.device

    # prompts and likelihoods ------------------------------------------------------------------

    def _read_template(self) -> None:
        """Read the special tokens, and the tokens of each answer, from the model's chat template.

        Raises ValueError for a chat template that omits a part of the conversation.
        """
        tokenizer = self.processor.tokenizer
        added = tokenizer.added_tokens_decoder.values()
        special = {*tokenizer.all_special_tokens, *(t.content for t in added if t.special)}
        names = ("image_token", "video_token", "fake_image_token")
        special |= {vars(self.processor).get(name) or "" for name in names} - {""}
        self._special = re.compile("|".join(map(re.escape, sorted(special, key=len)[::-1])))
        prompt = self._prompt("probe of the text", self.system_prompt, 0)
        for part, name in ((self.system_prompt or "", "system prompt"), ("probe of the text", "")):
            if part not in prompt:
                raise ValueError(
                    f"The chat template of {self.model} omits the {name or 'user message'}. "
                    "Choose an instruction-tuned model"
                    + (", or set agent.system_prompt=null." if name else ".")
                )
        rows = []
        for answer in self.answers:
            reply = {"role": "assistant", "content": [{"type": "text", "text": answer.text}]}
            messages = self.messages("probe of the text", self.system_prompt, [])
            before, text, after = self._render([*messages, reply], False).rpartition(answer.text)
            if not text:
                raise ValueError(
                    f"The chat template of {self.model} changes the answer {answer.text!r}, so it "
                    "cannot be scored. Choose a different model or agent.answers."
                )
            space = before[len(prompt) :] if before.startswith(prompt) else ""
            whole = space + text + after.rstrip()  # with the token that ends the turn
            rows.append(tokenizer(whole, add_special_tokens=False)["input_ids"])
        width = max(map(len, rows))
        ids = torch.tensor([row + row[-1:] * (width - len(row)) for row in rows])
        lengths = torch.tensor([[len(row)] for row in rows])
        self.register_buffer("_answer_ids", ids, persistent=False)
        self.register_buffer("_is_answer", torch.arange(width) < lengths, persistent=False)

    def _render(self, messages: list[dict], generation: bool) -> str:
        if self.processor.chat_template is None:
            raise ValueError(
                f"{self.model} has no chat template: choose an instruction-tuned model."
            )
        # the processor logs a warning if its template does not use the date
        uses_date = "date_string" in str(self.processor.chat_template)
        text = self.processor.apply_chat_template(
            messages,
            tokenize=False,
            add_generation_prompt=generation,
            **({"date_string": TEMPLATE_DATE} if uses_date else {}),
        )
        return str(text)

    def _prompt(self, instruction: str, system: str | None, images: int) -> str:
        """Return the text of the conversation before the answer."""
        # a special token in the text could end the user's turn or stand for an image
        instruction = self._special.sub(" ", instruction)
        system = None if system is None else self._special.sub(" ", system)
        return self._render(self.messages(instruction, system, [{"type": "image"}] * images), True)

    def _inputs(
        self, instruction: str, system: str | None, frames: Sequence[np.ndarray]
    ) -> dict[str, Tensor]:
        """Return the model's inputs for one decision with ``frames``, each uint8 [H, W, 3]."""
        from PIL import Image

        text = self._prompt(instruction, system, len(frames))
        begin = self.processor.tokenizer.bos_token
        inputs = self.processor(
            text=[text],
            images=[[Image.fromarray(frame) for frame in frames]],
            return_tensors="pt",
            add_special_tokens=not (begin and text.startswith(begin)),
            **self.images,
        )
        dtype = self.network.dtype
        on = {name: value.to(self.device) for name, value in inputs.items()}
        return {n: v.to(dtype) if v.is_floating_point() else v for n, v in on.items()}

    def _likelihoods(self, inputs: dict[str, Tensor]) -> Tensor:
        """Return the log-likelihood [n] of each answer after the prompt in ``inputs``."""
        return likelihoods(self.network, inputs, self._answer_ids, self._is_answer)

    def logits(self, memory: Memory) -> Tensor:
        """Return the log-likelihood [n] of each answer for the last frame of ``memory``."""
        frames = [memory.frames[i] for i in views_of(len(memory.frames), self.history)]
        inputs = self._inputs(memory.instruction, memory.system, frames)
        return check_logits(self._likelihoods(inputs), self)

    @torch.inference_mode()
    def ask(self, memories: Sequence[Memory]) -> list[Answer]:
        """Return the most likely answer of each episode."""
        return [self.answers[int(self.logits(memory).argmax())] for memory in memories]

    # training ---------------------------------------------------------------------------------

    def parts(self) -> dict[str, nn.Module]:
        """Return the network; all its weights except LoRA's are frozen."""
        return {"network": self.network}

    @torch.no_grad()
    def collect(
        self,
        worlds: Sequence[World],
        episodes: Sequence[Episode],
        *,
        expert_share: float,
        rngs: Sequence[np.random.Generator],
        clean: bool = False,
    ) -> Piece:
        """Run episodes and return the decisions with the expert's answers (``agents/agent.py``)."""

        def chances(memory: Memory) -> np.ndarray:
            return self.logits(memory).double().softmax(-1).cpu().numpy()

        runs = []
        for world, episode, rng in zip(worlds, episodes, rngs, strict=True):
            memory = self.begin(episode.instruction.text)
            targets, before = run_episode(
                world, episode, memory, chances, self.answers, expert_share, rng, clean, LIMIT
            )
            runs.append((episode, memory, targets, before))
        return piece_of(runs, self.history)

    def join(self, pieces: Sequence[Piece]) -> AnswerDecisions:
        """Join the decisions of several calls of :meth:`collect` into one batch."""
        return join_pieces(pieces, len(self.answers))

    def decide(self, decisions: AnswerDecisions, *, clean: bool = False) -> Output:
        """Return the log-likelihoods of the answers as logits [B, n]."""
        frames = decisions.clean if clean else decisions.frames
        assert frames is not None, "collect(clean=True) keeps clean frames"
        rows = []
        for text, views in zip(decisions.texts, decisions.views, strict=True):
            inputs = self._inputs(text, self.system_prompt, list(frames[views].numpy()))
            if self.checkpointing and torch.is_grad_enabled():
                rows.append(checkpoint(self._likelihoods, inputs, use_reentrant=False))
            else:
                rows.append(self._likelihoods(inputs))
        logits = torch.stack(rows)
        return Output(logits, figures=stop_figures(logits, decisions.target))

    def image_tokens(self, frames: Tensor) -> Tensor:
        """Return the tokens [n, d] that the language model receives for ``frames``.

        Args:
            frames: uint8 [V, H, W, 3].
        """
        # the processor accepts images only together with a prompt
        inputs = self._inputs("", None, list(frames.cpu().numpy()))
        encode = self.network.get_image_features
        accepted = signature(encode).parameters
        output = encode(**{name: value for name, value in inputs.items() if name in accepted})
        tokens = output if isinstance(output, Tensor | list | tuple) else output.pooler_output
        if isinstance(tokens, Tensor):
            return tokens.flatten(0, -2)
        return torch.cat([each.flatten(0, -2) for each in tokens])  # one tensor per image

    def image_lora(self) -> list[nn.Parameter]:
        """Return the LoRA weights of the image encoder and the projector."""
        language = {id(p) for p in self.network.get_decoder().parameters()}
        named = self.network.named_parameters()
        return [p for name, p in named if LORA in name and id(p) not in language]

    def as_teacher(self) -> VLMAgent:
        """Return a copy of the agent that shares the frozen weights and the processor."""
        frozen = [p for name, p in self.network.named_parameters() if LORA not in name]
        return copy.deepcopy(self, {id(shared): shared for shared in (self.processor, *frozen)})

    # files ------------------------------------------------------------------------------------

    def save(self, folder: str | Path) -> None:
        """Write the LoRA weights in PEFT's folder format, with the sha256 of the base model.

        Raises ValueError if the agent has no LoRA weights.
        """
        with folders.write_folder(folder, "agent") as draft:
            tensors = {name: value.cpu().clone() for name, value in self._adapter().items()}
            self.network.peft_config["default"].base_model_name_or_path = self.model
            self.network.save_pretrained(draft, state_dict=tensors, save_embedding_layers=False)
            for file in draft.iterdir():
                if file.name not in (CONFIG, PEFT_WEIGHTS):
                    file.unlink()  # the README template that PEFT writes
            base = {"model": self.model, "sha256": self._base()}
            write_json(draft / BASE, base, indent=1)

    def load(self, folder: str | Path) -> None:
        """Load LoRA weights from a PEFT folder.

        Modules of ``agent.lora`` without weights in the folder keep their original output.

        Raises FileNotFoundError if the folder contains no LoRA weights. Raises ValueError if the
        weights are damaged, or were trained for a different base model, for modules that
        ``agent.lora`` lacks, or with another rank or alpha.
        """
        from peft import set_peft_model_state_dict

        file = Path(folder) / PEFT_WEIGHTS
        if not file.is_file():
            raise FileNotFoundError(
                f"There is no LoRA adapter at {folder}: expected {PEFT_WEIGHTS}, which `make train "
                "ARGS=agent=vlm` and PEFT write."
            )
        # this file is missing in folders that other programs wrote
        if (file.parent / BASE).is_file():
            base = read_object(file.parent / BASE, "Fetch the folder again, or train again.")
            if base.get("sha256") != self._base():
                raise ValueError(
                    f"The adapter {folder} was trained on the model {str(base.get('model')):.200}, "
                    f"whose sha256 differs from the sha256 of {self.model}. Set agent.model to the "
                    "model on which the adapter was trained."
                )
        tensors = load_tensors(file)
        expected = self._adapter()
        absent = expected.keys() - tensors.keys()
        invalid = {name for name in tensors if name not in expected}
        invalid |= {n for n in tensors.keys() & expected if tensors[n].shape != expected[n].shape}
        # the two matrices of a module must both be present or both be absent
        invalid |= {name for name in absent if _other_matrix(name) not in absent}
        if invalid or not tensors:
            raise ValueError(
                f"{file} does not fit agent.lora: {len(invalid)} tensors are missing, unknown or "
                f"of another shape ({', '.join(sorted(invalid)[:3])} ...). Copy r and modules from "
                f"its {CONFIG}."
            )
        self._check_scale(file.parent / CONFIG)
        if absent:
            say(
                f"{folder} has no LoRA weights for {len(absent) // 2} modules of agent.lora; their "
                "LoRA output starts at zero"
            )
        zero = {n: torch.zeros_like(expected[n]) if "lora_B" in n else expected[n] for n in absent}
        set_peft_model_state_dict(self.network, {**tensors, **zero})

    def _check_scale(self, file: Path) -> None:
        """Raise ValueError if PEFT's config in ``file`` scales LoRA outputs in another way."""
        if not file.is_file():
            return
        stored = read_object(file, "Fetch the folder again, or train again.")
        own = self.network.peft_config["default"]
        for name in ("lora_alpha", "use_rslora", "use_dora"):
            if name in stored and stored[name] != getattr(own, name):
                raise ValueError(
                    f"{name} in {file} is {stored[name]!r:.80}, but the agent has "
                    f"{getattr(own, name)!r}. Copy alpha to agent.lora; other kinds of scaling are "
                    "not supported."
                )

    def _base(self) -> str:
        return bytes(self.base_sha256.tolist()).hex()

    def _adapter(self) -> dict[str, Tensor]:
        """Return the LoRA weights with PEFT's names."""
        from peft import PeftModel, get_peft_model_state_dict

        if not isinstance(self.network, PeftModel):
            raise ValueError("The agent has no LoRA weights: set agent.lora (conf/agent/vlm.yaml).")
        return get_peft_model_state_dict(self.network)


def load_processor(place: str) -> Any:
    """Return the processor of the model ``place`` (a folder or hub id), without its video part.

    The agent sends images only, and the video processors of transformers would require torchvision.
    """
    from transformers import AutoConfig
    from transformers.models.auto.processing_auto import PROCESSOR_MAPPING

    config = AutoConfig.from_pretrained(place, trust_remote_code=False)
    if type(config) not in PROCESSOR_MAPPING:
        raise ValueError(f"transformers has no processor for {config.model_type}.")
    kind: Any = PROCESSOR_MAPPING[type(config)]

    class ImagesOnly(kind):
        @classmethod
        def get_attributes(cls) -> list[str]:
            return [name for name in kind.get_attributes() if "video" not in name]

    processor = ImagesOnly.from_pretrained(place, trust_remote_code=False)
    processor.__class__ = kind  # restore the class, because a local class cannot be pickled
    return processor


def likelihoods(network: Any, inputs: Mapping[str, Tensor], ids: Tensor, mask: Tensor) -> Tensor:
    """Return the log-likelihood [n] of each answer after a prompt.

    The prompt is computed once, and its keys and values are repeated for the answers. Answers are
    padded on the right, and causal attention ignores later tokens.

    Args:
        network: a causal language model of the transformers library.
        inputs: the model's inputs for the prompt, with batch size 1.
        ids: token ids [n, L] of the answers.
        mask: bool [n, L], False for padding.
    """
    prompt = network(**inputs, use_cache=True, logits_to_keep=1)
    # transformers 5.24 renamed this argument
    name = "cache" if "cache" in prompt else "past_key_values"
    prompt[name].batch_repeat_interleave(len(ids))
    logits = prompt.logits[:, -1:].expand(len(ids), -1, -1)
    if ids.shape[1] > 1:
        rest = network(input_ids=ids[:, :-1], use_cache=True, **{name: prompt[name]})
        logits = torch.cat([logits, rest.logits], 1)
    each = logits.float().log_softmax(-1).gather(-1, ids[..., None])[..., 0]
    for module in network.modules():  # Qwen's models keep this state of the last prompt
        if vars(module).get("rope_deltas") is not None:
            module.rope_deltas = None
    return (each * mask).sum(-1)


def _other_matrix(name: str) -> str:
    """Return the name of the LoRA module's other matrix."""
    if "lora_A" in name:
        return name.replace("lora_A", "lora_B")
    return name.replace("lora_B", "lora_A")


def _with_lora(network: Any, lora: Mapping[str, Any]) -> nn.Module:
    """Add LoRA to the linear modules of ``network`` that ``lora`` selects.

    Raises ValueError if a name matches no module.
    """
    from peft import LoraConfig, get_peft_model

    language = {id(module) for module in network.get_decoder().modules()}
    linear = [(n, m) for n, m in network.named_modules() if isinstance(m, nn.Linear)]
    head = network.get_output_embeddings()
    targets = []
    for part in ("language", "vision"):
        inside = [
            n for n, m in linear if m is not head and (id(m) in language) == (part == "language")
        ]
        if lora.get(part) == ALL_LINEAR:
            targets += inside
            continue
        for name in lora.get(part) or ():
            matching = [place for place in inside if place.rpartition(".")[2] == name]
            if not matching:
                names = {place.rpartition(".")[2] for place in inside}
                raise ValueError(unknown(f"linear module (agent.lora.{part})", name, names))
            targets += matching
    config = LoraConfig(
        r=lora["r"],
        lora_alpha=lora["alpha"],
        lora_dropout=lora.get("dropout", 0.0),
        target_modules=targets,
    )
    return get_peft_model(network, config)
