"""The remote agent asks a vision-language model over HTTP (OpenAI-compatible chat).

The model runs on a different machine, for example in vLLM. Several episodes run at once, each with
its own request, deadline and retries.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import cv2
import numpy as np

from mitigate.agents.vlm.answers import LONGEST, Answer, answer_for, read_answer
from mitigate.agents.vlm.conversation import SYSTEM, AnsweringAgent, Memory, views_of
from mitigate.core.chat import ChatClient, NoAnswer
from mitigate.core.names import short
from mitigate.core.observation import LEFT
from mitigate.core.progress import say

OPTIONS = {"temperature": 0, "max_tokens": 32}


class RemoteAgent(AnsweringAgent):
    """Choose each action by asking a chat model that reads images.

    An answer that is not exactly one of the allowed answers is counted and reported, and
    ``otherwise`` is taken instead. If the endpoint gives no answer after all retries, the
    evaluation stops with an error. Finished rows stay in their file, and running the same command
    again adds the missing rows.

    Args:
        url: address without ``/chat/completions``, such as ``http://localhost:8000/v1``.
        model: name of the model at the endpoint.
        answers, history, task, system_prompt: see ``AnsweringAgent``.
        otherwise: the allowed answer that replaces an unreadable answer. None means the shortest
            turn to the left.
        together: number of episodes that run at once.
        timeout: seconds for one request.
        retries: number of retries of a request after a temporary failure.
        pause: seconds before the first retry; the pause doubles before each later retry.

    Raises:
        ValueError: If a setting is invalid.
    """

    def __init__(
        self,
        url: str,
        model: str | None = None,
        answers: str = "navid",
        history: int = 4,
        task: str | None = None,
        system_prompt: str | None = SYSTEM,
        otherwise: str | None = None,
        together: int = 16,
        timeout: float = 60.0,
        retries: int = 5,
        pause: float = 1.0,
    ) -> None:
        if not model:
            raise ValueError("agent.model must be the name of the model at the endpoint.")
        self.prepare(answers, history, task, system_prompt)
        left = self.answers[answer_for(LEFT, 1, self.answers)]
        fallback = left if otherwise is None else read_answer(otherwise, self.answers)
        if fallback is None:
            allowed = ", ".join(answer.text for answer in self.answers)
            raise ValueError(f"agent.otherwise must be one of {allowed}, got {otherwise!r:.80}.")
        if together < 1:
            raise ValueError(f"agent.together must be >= 1, got {together}.")
        self.otherwise = fallback
        self.together = together
        self.client = ChatClient(
            url, model, timeout=timeout, retries=retries, pause=pause, options=OPTIONS
        )
        self._settings |= {
            "url": self.client.url,
            "model": model,
            "otherwise": fallback.text,
            "options": self.client.options,
        }
        self.answered = 0
        self.unreadable = 0

    def settings(self) -> dict[str, Any]:
        """Return what determines the actions; deadlines and retries are left out."""
        return dict(self._settings)

    def ask(self, memories: Sequence[Memory]) -> list[Answer]:
        """Return the answer of each episode; the requests run at the same time.

        Raises ConnectionError if a request got no answer.
        """
        if not memories:
            return []
        with ThreadPoolExecutor(len(memories)) as pool:
            texts = list(pool.map(self._ask, memories))
        return [self._read(text, memory) for text, memory in zip(texts, memories, strict=True)]

    def episode_figures(self, memory: Memory | None) -> dict[str, int]:
        """Return the number of unreadable answers, which is stored in the row of the episode."""
        memory = memory or self._memory
        return {} if memory is None else {"unreadable_answers": memory.unreadable}

    def _ask(self, memory: Memory) -> str:
        frames = [memory.frames[index] for index in views_of(len(memory.frames), self.history)]
        images = [{"type": "image_url", "image_url": {"url": _png(frame)}} for frame in frames]
        try:
            messages = self.messages(memory.instruction, memory.system, images)
            return self.client.ask(messages, LONGEST)
        except NoAnswer as error:
            raise ConnectionError(
                f"The served agent gave no answer after {self.client.retries + 1} attempts "
                f"({error}). Check the server, and run the same command again: rows are kept."
            ) from error

    def _read(self, text: str, memory: Memory) -> Answer:
        self.answered += 1
        answer = read_answer(text, self.answers)
        if answer is not None:
            return answer
        memory.unreadable += 1
        self.unreadable += 1
        # warn at 1, 2, 4, 8 ... unreadable answers
        if self.unreadable & (self.unreadable - 1) == 0:
            say(
                f"{self.client.model}: {self.unreadable} of {self.answered} answers are not one "
                f"of the allowed answers, the last {short(text)}; each counts as "
                f'"{self.otherwise.text}"'
            )
        return self.otherwise


def _png(frame: np.ndarray) -> str:
    """Return a frame uint8 [H, W, 3] as a data URL; PNG keeps every pixel."""
    _, data = cv2.imencode(".png", frame[..., ::-1])
    return f"data:image/png;base64,{base64.b64encode(data.tobytes()).decode()}"
