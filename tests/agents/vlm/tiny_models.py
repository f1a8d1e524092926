"""Randomly initialised vision-language models of three architectures, built without internet
access.

Layer widths are multiples of 64, because bitsandbytes requires this on some CPUs. The processor
consists of a tokenizer that is trained here and an image processor of transformers that needs only
Pillow.
"""

from __future__ import annotations

import json
from pathlib import Path

import torch

SYSTEM_TEMPLATE = (
    "{% for m in messages %}<|im_start|>{{ m['role'] }}\n"
    "{% for part in m['content'] %}"
    "{% if part['type'] == 'image' %}IMAGE{% else %}{{ part['text'] }}{% endif %}"
    "{% endfor %}<|im_end|>\n{% endfor %}"
    "{% if add_generation_prompt %}<|im_start|>assistant\n{% endif %}"
)
LANGUAGE = {
    "hidden_size": 64,
    "intermediate_size": 64,
    "num_hidden_layers": 2,
    "num_attention_heads": 4,
    "num_key_value_heads": 4,
    "max_position_embeddings": 4096,
}
ARCHITECTURES = ("qwen2_5_vl", "llava_onevision", "idefics3")
SIDE = 28  # side in pixels of the images that LLaVA-OneVision and Idefics3 process


def tokenizer(special: list[str]):
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers, trainers
    from transformers import PreTrainedTokenizerFast

    tokens = Tokenizer(models.BPE())
    tokens.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    tokens.decoder = decoders.ByteLevel()
    trainer = trainers.BpeTrainer(
        vocab_size=400,
        special_tokens=["<|im_start|>", "<|im_end|>", *special],
        initial_alphabet=pre_tokenizers.ByteLevel.alphabet(),
        show_progress=False,
    )
    text = "turn left 30 degrees, turn right 15 degrees, forward 75 cm, stop. Walk to the sofa."
    tokens.train_from_iterator([text] * 4, trainer)
    return PreTrainedTokenizerFast(
        tokenizer_object=tokens, eos_token="<|im_end|>", pad_token="<|im_end|>"
    )


def write_model(folder: Path, architecture: str) -> str:
    """Write a model with its processor to ``folder``, and return the folder."""
    torch.manual_seed(0)
    network, images, words, image, settings = globals()[f"_{architecture}"]()
    template = SYSTEM_TEMPLATE.replace("IMAGE", image)
    network.save_pretrained(folder)
    images.save_pretrained(folder)
    words.save_pretrained(folder)
    (folder / "chat_template.jinja").write_text(template, "utf-8")
    (folder / "processor_config.json").write_text(json.dumps(settings), "utf-8")
    return str(folder)


def _qwen2_5_vl():
    from transformers import Qwen2_5_VLConfig, Qwen2_5_VLForConditionalGeneration
    from transformers.models.qwen2_vl.image_processing_pil_qwen2_vl import Qwen2VLImageProcessorPil

    special = ["<|vision_start|>", "<|vision_end|>", "<|image_pad|>", "<|video_pad|>"]
    words = tokenizer(special)
    ids = dict(zip(special, words.convert_tokens_to_ids(special), strict=True))
    vision = {
        "depth": 2, "hidden_size": 64, "intermediate_size": 64, "num_heads": 2, "patch_size": 7,
        "window_size": 28, "out_hidden_size": 64, "fullatt_block_indexes": [1],
    }  # fmt: skip
    text = {**LANGUAGE, "vocab_size": len(words), "bos_token_id": None, "eos_token_id": 1}
    text["rope_parameters"] = {"rope_type": "default", "mrope_section": [2, 3, 3]}
    config = Qwen2_5_VLConfig(
        text_config=text,
        vision_config=vision,
        image_token_id=ids["<|image_pad|>"],
        video_token_id=ids["<|video_pad|>"],
        vision_start_token_id=ids["<|vision_start|>"],
        vision_end_token_id=ids["<|vision_end|>"],
    )
    images = Qwen2VLImageProcessorPil(
        patch_size=7, size={"shortest_edge": 14 * 14, "longest_edge": 28 * 28}
    )
    image = "<|vision_start|><|image_pad|><|vision_end|>"
    kind = {"processor_class": "Qwen2_5_VLProcessor"}
    return Qwen2_5_VLForConditionalGeneration(config), images, words, image, kind


def _siglip() -> dict:
    return {
        "model_type": "siglip_vision_model", "hidden_size": 64, "intermediate_size": 64,
        "num_hidden_layers": 2, "num_attention_heads": 2, "image_size": SIDE, "patch_size": 7,
    }  # fmt: skip


def _llava_onevision():
    from transformers import LlavaOnevisionConfig, LlavaOnevisionForConditionalGeneration
    from transformers.models.llava_onevision.image_processing_pil_llava_onevision import (
        LlavaOnevisionImageProcessorPil,
    )

    words = tokenizer(["<image>", "<video>"])
    grid = [[SIDE, SIDE]]
    config = LlavaOnevisionConfig(
        text_config={"model_type": "qwen2", **LANGUAGE, "vocab_size": len(words)},
        vision_config=_siglip(),
        image_token_id=words.convert_tokens_to_ids("<image>"),
        video_token_id=words.convert_tokens_to_ids("<video>"),
        image_grid_pinpoints=grid,
        vision_feature_layer=-1,
        vision_feature_select_strategy="full",
    )
    images = LlavaOnevisionImageProcessorPil(
        size={"height": SIDE, "width": SIDE}, image_grid_pinpoints=grid
    )
    settings = {
        "processor_class": "LlavaOnevisionProcessor",
        "num_image_tokens": (SIDE // 7) ** 2,
        "vision_feature_select_strategy": "full",
    }
    return LlavaOnevisionForConditionalGeneration(config), images, words, "<image>", settings


def _idefics3():
    from transformers import Idefics3Config, Idefics3ForConditionalGeneration
    from transformers.models.idefics3.image_processing_pil_idefics3 import (
        Idefics3ImageProcessorPil,
    )

    special = ["<fake_token_around_image>", "<image>", "<end_of_utterance>", "<global-img>"]
    words = tokenizer(special)
    vision = {n: v for n, v in _siglip().items() if n != "model_type"}
    config = Idefics3Config(
        text_config={"model_type": "llama", **LANGUAGE, "vocab_size": len(words)},
        vision_config=vision,
        image_token_id=words.convert_tokens_to_ids("<image>"),
        scale_factor=2,
    )
    images = Idefics3ImageProcessorPil(
        size={"longest_edge": SIDE}, max_image_size={"longest_edge": SIDE}, do_image_splitting=False
    )
    settings = {"processor_class": "Idefics3Processor", "image_seq_len": 4}
    return Idefics3ForConditionalGeneration(config), images, words, "<image>", settings
