"""Write a small vision-language model, made from parts that pip installs, to a folder.

    python -m tools.small_vlm FOLDER

The language model consists of the embeddings and the first layers of SmolLM2-135M-Instruct. The
image encoder (a vision transformer) and the projector are random; train them with
``agent.lora.vision=all-linear``. The architecture is Idefics3, as in SmolVLM.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import torch

from mitigate.core.files import write_json, write_text
from mitigate.guards.text.language_models.base import SMOLLM2, load_base

SIDE, PATCH = 64, 8  # side of images and of patches, in pixels
SCALE = 4  # the projector joins SCALE x SCALE patches to one token
SPECIAL = ["<fake_token_around_image>", "<image>", "<end_of_utterance>", "<global-img>"]
TEMPLATE = (
    "{% for m in messages %}<|im_start|>{{ m['role'] }}\n"
    "{% for part in m['content'] %}"
    "{% if part['type'] == 'image' %}<image>{% else %}{{ part['text'] }}{% endif %}"
    "{% endfor %}<|im_end|>\n{% endfor %}"
    "{% if add_generation_prompt %}<|im_start|>assistant\n{% endif %}"
)
VISION = {
    "hidden_size": 192,
    "intermediate_size": 512,
    "num_hidden_layers": 4,
    "num_attention_heads": 4,
    "image_size": SIDE,
    "patch_size": PATCH,
}


def write_model(folder: Path, layers: int) -> None:
    """Write the model with its processor to ``folder``.

    Args:
        folder: the output folder.
        layers: number of layers of the language model, at most 30.
    """
    from transformers import Idefics3Config, Idefics3ForConditionalGeneration
    from transformers.models.idefics3.image_processing_pil_idefics3 import (
        Idefics3ImageProcessorPil,
    )

    tokenizer, language = load_base(SMOLLM2, "fp32")
    tokenizer.add_special_tokens({"additional_special_tokens": SPECIAL})
    tokenizer.chat_template = None  # replaced by TEMPLATE
    text: dict[str, Any] = {**language.config.to_dict(), "num_hidden_layers": layers}
    for name in ("quantization_config", "architectures", "dtype"):
        text.pop(name, None)
    torch.manual_seed(0)
    network = Idefics3ForConditionalGeneration(
        Idefics3Config(
            text_config=text,
            vision_config=VISION,
            image_token_id=tokenizer.convert_tokens_to_ids("<image>"),
            scale_factor=SCALE,
            tie_word_embeddings=True,
            pad_token_id=tokenizer.pad_token_id,
        )
    )
    network.model.text_model.load_state_dict(
        {
            name.removeprefix("model."): value
            for name, value in language.state_dict().items()
            if name.startswith("model.") and _layer(name) < layers
        }
    )
    network.resize_token_embeddings(len(tokenizer))  # ``SPECIAL`` adds tokens
    network.tie_weights()
    network.save_pretrained(folder)
    image_processor = Idefics3ImageProcessorPil(
        size={"longest_edge": SIDE}, max_image_size={"longest_edge": SIDE}, do_image_splitting=False
    )
    image_processor.save_pretrained(folder)
    tokenizer.save_pretrained(folder)
    write_text(folder / "chat_template.jinja", TEMPLATE)
    tokens = (SIDE // PATCH // SCALE) ** 2
    settings = {"processor_class": "Idefics3Processor", "image_seq_len": tokens}
    write_json(folder / "processor_config.json", settings)


def _layer(name: str) -> int:
    """Return the layer of a weight "model.layers.N. ...", or -1 outside the layers."""
    return int(name.split(".")[2]) if name.startswith("model.layers.") else -1


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="output folder")
    parser.add_argument(
        "--layers", type=int, default=8, choices=range(1, 31), metavar="N",
        help="layers of the language model, 1 to 30 (default: %(default)s)",
    )  # fmt: skip
    arguments = parser.parse_args()
    write_model(arguments.folder, arguments.layers)


if __name__ == "__main__":
    main()
