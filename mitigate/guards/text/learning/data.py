"""Generate training pairs of a corrupted text and its plain version, and read chat files.

Pairs are generated when they are needed. The pair with a given seed and index is the same in every
process. Texts come from :mod:`mitigate.guards.text.learning.routes` and, if given, from a user's
R2R or RxR episode files.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mitigate.core.files import open_text
from mitigate.core.seeding import digest, generator, pick
from mitigate.corruptions.instruction import corrupt_instruction, prefixes
from mitigate.corruptions.keying import Key
from mitigate.corruptions.language.clauses import clauses
from mitigate.corruptions.language.fidelity import check
from mitigate.corruptions.language.phrases import VOICES
from mitigate.corruptions.language.style import MANNERS
from mitigate.corruptions.language.text import is_english
from mitigate.guards.text.learning import spoken
from mitigate.guards.text.learning.routes import draw_route
from mitigate.worlds.episodes import read_episodes

KINDS = {  # fraction of pairs of each kind (heuristic, chosen on the validation families)
    "identity": 0.16,
    "style": 0.18,
    "spoken": 0.40,
    "mask": 0.10,
    "capitalize": 0.04,
    "black_box": 0.12,
}
MASKS = ("[MASK]", "[MASK]", "[MASK]", "<mask>", "[UNK]")
# maximum number of characters per line of a chat file; longer lines raise an error (heuristic)
LONGEST_LINE = 1_000_000
_HELD_OUT = 8  # one of every _HELD_OUT style phrases is excluded from training (heuristic)
_SENTENCE = re.compile(r"(?<=[.!?])\s+")
# parts of attack sentences, and the patterns that combine them, written for this project
_PHRASES = json.loads(Path(__file__).with_name("attack_phrases.json").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Pair:
    """A training pair.

    ``source`` is the text that the model reads. ``target`` is the plain text that it must write.
    ``kind`` is one of ``KINDS``.
    """

    source: str
    target: str
    kind: str


def draw_pair(seed: int, index: int, texts: Sequence[str] = (), share: float = 0.5) -> Pair:
    """Generate the training pair with this seed and index.

    A fraction ``share`` of all pairs is made from ``texts``, and the others from templates.
    """
    from_templates = not texts or generator(seed, "own", index).random() >= share
    hand_written = from_templates and spoken.available()
    kinds = {kind: part for kind, part in KINDS.items() if hand_written or kind != "spoken"}
    parts = np.array(list(kinds.values()))
    kind = str(generator(seed, "kind", index).choice(list(kinds), p=parts / parts.sum()))
    for attempt in range(100):
        rng = generator(seed, "pair", index, attempt)
        clean = draw_route(rng) if from_templates else pick(texts, rng)
        pair = _MAKE[kind](clean, Key(seed, f"pair {index} {attempt}"), rng)
        if pair is not None:
            return pair
    raise ValueError(
        "No training pair could be made from these texts: none of 100 sampled texts is an English "
        "route instruction that the corruption can change. Check the files in recipe.files."
    )


def _identity(clean: str, key: Key, rng: np.random.Generator) -> Pair | None:
    window = _window(_SENTENCE.split(clean), rng)
    return Pair(window, window, "identity") if window else None


def _capitals(clean: str, key: Key, rng: np.random.Generator) -> Pair | None:
    text = _window(_SENTENCE.split(clean), rng)
    loud = corrupt_instruction(text, "capitalize", float(rng.uniform(0.3, 1.0)), key, split="train")
    return Pair(loud, text, "capitalize")


def _masked(clean: str, key: Key, rng: np.random.Generator) -> Pair | None:
    text = _window(_SENTENCE.split(clean), rng)
    token, severity = str(rng.choice(MASKS)), float(rng.uniform(0.3, 1.0))
    masked = corrupt_instruction(text, "mask", severity, key, split="train", mask_token=token)
    return Pair(masked, text, "mask") if token in masked else None


def _attacked(clean: str, key: Key, rng: np.random.Generator) -> Pair | None:
    attack = " ".join(attacks(rng))
    if rng.random() < 0.3:  # a passage may contain nothing but an attack
        return Pair(attack, "", "black_box")
    if rng.random() < 0.3 and spoken.available():
        source, plain = spoken.passage(rng)
        return Pair(f"{attack} {source}", plain, "black_box")
    text = _window(_SENTENCE.split(clean), rng)
    return Pair(f"{attack} {text}", text, "black_box")


def _styled(clean: str, key: Key, rng: np.random.Generator) -> Pair | None:
    manner = str(rng.choice(MANNERS))
    source = corrupt_instruction(clean, manner, 1.0, key, split="train")
    commands = [_sentence(clause) for clause in clauses(clean)]
    if source == clean or holds_held_out(source, manner):
        return None
    aligned = _align(commands, _SENTENCE.split(source))
    if aligned is None:
        return None
    first = int(rng.integers(len(aligned))) if rng.random() < 0.5 else 0
    part = aligned[first : first + int(rng.integers(1, 6))]
    target = " ".join(commands[i] for _, i in part if i is not None)
    return Pair(" ".join(sentence for sentence, _ in part), target, "style")


_MAKE = {
    "identity": _identity,
    "capitalize": _capitals,
    "mask": _masked,
    "black_box": _attacked,
    "style": _styled,
    "spoken": lambda clean, key, rng: Pair(*spoken.passage(rng), "spoken"),
}


def attacks(rng: np.random.Generator) -> list[str]:
    """Return one to three attack sentences.

    Each sentence is sampled from the train split of the attacks, or composed by :func:`vary`.
    """
    bank = [sentence for group in prefixes("train").values() for sentence in group]
    count = int(rng.integers(1, 4))
    return [pick(bank, rng) if rng.random() < 0.4 else vary(rng) for _ in range(count)]


def vary(rng: np.random.Generator) -> str:
    """Compose an attack sentence from random phrases, similar to the attacks of the train split."""
    pattern, *slots = pick(_PHRASES["patterns"], rng)
    text = pattern.format(*(pick(_PHRASES[slot], rng) for slot in slots))
    return text[0].upper() + text[1:] + ("." if rng.random() < 0.9 else "!")


def holds_held_out(source: str, manner: str) -> bool:
    """Return whether ``source`` contains a phrase that is excluded from training.

    ``manner`` is the style of ``source``.
    """
    return any(pattern.search(source) for pattern in held_out(manner))


def held_out(manner: str) -> list[re.Pattern[str]]:
    """Return patterns that match those phrases of a style that are excluded from training.

    Phrases are openers, frames, commands and closers.
    """
    voice = VOICES[manner]
    groups = [voice.openers, voice.closers, *voice.frames.values(), *voice.commands.values()]
    phrases = {p for group in groups for p in group if len(re.sub(r"\{\w*\}", "", p).split()) > 1}
    kept_out = [p for p in sorted(phrases) if digest("held out", p) % _HELD_OUT == 0]
    return [
        re.compile(r".{0,60}?".join(map(re.escape, re.split(r"\{\w*\}", p))), re.IGNORECASE)
        for p in kept_out
    ]


def _sentence(clause: Any) -> str:
    text = f"{clause.when}, {clause.main}" if clause.when else clause.main
    return text[:1].upper() + text[1:] + "."


def _align(commands: list[str], source: list[str]) -> list[tuple[str, int | None]] | None:
    """Return pairs of each styled sentence and the index of its plain command.

    The index is None for a sentence without a command. If the commands cannot be assigned to
    sentences, the result is None.
    """
    pairs: list[tuple[str, int | None]] = []
    at = 0
    for sentence in source:
        fits = at < len(commands) and len(sentence.split()) > 1
        fits = fits and not check(commands[at], sentence)
        frames = not pairs and len(source) != len(commands)
        if fits and not (frames and not _tells(sentence, commands[0])):
            pairs.append((sentence, at))
            at += 1
        else:
            pairs.append((sentence, None))
    return pairs if at == len(commands) else None


def _tells(sentence: str, command: str) -> bool:
    """Return whether two texts have a content word in common."""
    words = {w for w in re.findall(r"[a-z]+", command.lower()) if len(w) > 3}
    return bool(words & set(re.findall(r"[a-z]+", sentence.lower())))


def _window(sentences: list[str], rng: np.random.Generator) -> str:
    """Return all sentences or 1 to 3 consecutive ones, similar to the safeguard's passages."""
    if rng.random() < 0.4:
        return " ".join(sentences)
    first = int(rng.integers(len(sentences)))
    return " ".join(sentences[first : first + int(rng.integers(1, 4))])


def read_texts(files: Iterable[str | Path]) -> list[str]:
    """Return the English instructions in R2R or RxR episode files, without duplicates."""
    texts: dict[str, None] = {}
    for file in files:
        for episode in read_episodes(file):
            text = " ".join(episode.instruction.text.split())
            if is_english(episode.instruction.language, text) and len(text.split()) > 2:
                texts[text] = None
    return list(texts)


def read_chats(path: str | Path) -> Iterator[Pair]:
    """Yield the pairs of a chat file, one per line.

    A line is ``{"messages": [system, user, assistant]}``; the system message is optional. If a line
    is invalid, raises a ValueError that names the file, the line and the problem.
    """
    with open_text(path) as file:
        for number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE), ""), 1):
            if line.strip():
                yield _pair(line, f"{path}, line {number}")


def _pair(line: str, where: str) -> Pair:
    try:
        chat = json.loads(line)
        turns = [(m["role"], m["content"]) for m in chat["messages"] if m["role"] != "system"]
        problem = f"holds the roles {[role for role, _ in turns]}, not one user and one assistant"
        if [role for role, _ in turns] == ["user", "assistant"]:
            source, target = (content for _, content in turns)
            if isinstance(source, str) and isinstance(target, str) and source.strip():
                return Pair(source, target, str(chat.get("kind", "chat")))
            problem = "has an empty user text, or a content that is not text"
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        problem = f"is no chat ({type(error).__name__}: {error})"
    raise ValueError(
        f"{where} {problem:.300}. A chat line is one JSON object like "
        '{"messages": [{"role": "user", "content": "PLEASE turn left."}, {"role": "assistant", '
        '"content": "Turn left."}]}. Fix or delete that line.'
    )
