"""Load the processor of a vision-language model: its tokenizer and its image processor."""

from __future__ import annotations

from typing import Any


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
