# SPDX-License-Identifier: GPL-3.0-or-later
"""The services that the preferences offer by name: where each is, where its key comes from, and what it costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal
from urllib.parse import urlsplit

ClientKind = Literal["builtin", "openai", "anthropic", "gemini", "ollama", "recorded", "manual"]


@dataclass(frozen=True)
class Preset:
    """One choice of provider.

    Attributes:
        id: as in the preferences; number: kept in Blender's preferences file, never changed.
        title, tooltip: for the list; note: where to get a key and what it costs, or that it is local.
        key_page: address of the page with the keys; key_variable: environment variable in which its users keep it.
        key: whether the service wants a key; at_once: questions that it is sent side by side, 0 for as many as usual.
    """

    id: str
    number: int
    title: str
    tooltip: str
    note: str
    kind: ClientKind
    base_url: str = ""
    key_page: str = ""
    key_variable: str = ""
    key: Literal["needed", "optional", "none"] = "none"
    at_once: int = 0

    @property
    def host(self) -> str:
        """The host of the preset's own address."""
        return urlsplit(self.base_url).hostname or ""


PRESETS = (
    Preset(
        "BUILTIN",
        0,
        "Built-in analysis",
        "No model and no network: the picture is measured on this computer",
        "No model is used: walls, floor and furniture are measured in the picture. Free. Works best on clean pictures.",
        "builtin",
    ),
    Preset(
        "OPENAI",
        3,
        "OpenAI",
        "OpenAI's models, on the internet",
        "Needs a key with credit; a chat subscription does not include it. You pay OpenAI for every question.",
        "openai",
        "https://api.openai.com/v1",
        "https://platform.openai.com/api-keys",
        "OPENAI_API_KEY",
        "needed",
    ),
    Preset(
        "ANTHROPIC",
        4,
        "Anthropic",
        "Anthropic's Claude models, on the internet",
        "Needs a key with credit; a chat subscription does not include it. You pay Anthropic for every question.",
        "anthropic",
        "https://api.anthropic.com/v1",
        "https://platform.claude.com/settings/keys",
        "ANTHROPIC_API_KEY",
        "needed",
    ),
    Preset(
        "GEMINI",
        5,
        "Google Gemini",
        "Google's Gemini models, on the internet",
        "Needs a key; some models have a free amount a day, others are paid for by the question.",
        "gemini",
        "https://generativelanguage.googleapis.com/v1beta",
        "https://aistudio.google.com/apikey",
        "GEMINI_API_KEY",
        "needed",
    ),
    Preset(
        "OPENROUTER",
        6,
        "OpenRouter",
        "Many makers' models behind one address, on the internet",
        "Needs a key with credit. One account for many makers' models; prices come with the list of models.",
        "openai",
        "https://openrouter.ai/api/v1",
        "https://openrouter.ai/keys",
        "OPENROUTER_API_KEY",
        "needed",
    ),
    Preset(
        "LMSTUDIO",
        7,
        "LM Studio",
        "A model in LM Studio on this computer",
        "Free, and nothing leaves this computer. In LM Studio, load a model that sees pictures and start the server.",
        "openai",
        "http://localhost:1234/v1",
    ),
    Preset(
        "OLLAMA",
        8,
        "Ollama",
        "A model in Ollama on this computer",
        "Free, and nothing leaves this computer. Pull a model that sees pictures, with a long context.",
        "ollama",
        "http://localhost:11434",
        key="optional",
    ),
    Preset(
        "OLLAMA_OPENAI",
        9,
        "Ollama (OpenAI-style address)",
        "A model in Ollama, asked like OpenAI; its context length is set in Ollama itself",
        "Free, and nothing leaves this computer. Set a context of 16k or more in Ollama, or prompts are cut silently.",
        "openai",
        "http://localhost:11434/v1",
        key="optional",
    ),
    Preset(
        "LLAMACPP",
        10,
        "llama.cpp",
        "A model in llama.cpp's server on this computer",
        "Free, and nothing leaves this computer. Start llama-server with a model and its picture part (--mmproj).",
        "openai",
        "http://localhost:8080/v1",
        key="optional",
    ),
    Preset(
        "VLLM",
        11,
        "vLLM",
        "A model in a vLLM server of your own",
        "Free of charges by the question. Start vLLM with a model that sees pictures.",
        "openai",
        "http://localhost:8000/v1",
        key="optional",
        at_once=4,
    ),
    Preset(
        "CUSTOM",
        1,
        "Other OpenAI-style service",
        "Any service with an OpenAI-style address, on this computer or on the internet",
        "Any service that speaks like OpenAI. Ask it for its address, a key and its prices.",
        "openai",
        "http://localhost:1234/v1",
        key="optional",
    ),
    Preset(
        "MANUAL",
        12,
        "Any chat, by hand",
        "You copy each prompt into any chat and paste its answer here; no key is needed",
        "Works with any chat that sees pictures, without a key. A room takes about 10 to 30 prompts. Blender sends nothing.",
        "manual",
    ),
    Preset(
        "RECORDED",
        2,
        "Recorded answers",
        "Play back answers that were recorded in a folder, as with the samples",
        "Answers that were recorded earlier are played back. Free, and nothing leaves this computer.",
        "recorded",
    ),
)


def preset(identifier: str) -> Preset:
    """A preset by its id, in any case; the other OpenAI-style service where there is none."""
    wanted = identifier.strip().upper().replace("-", "_").replace(".", "")
    return next((p for p in PRESETS if p.id == wanted), next(p for p in PRESETS if p.id == "CUSTOM"))


def own_key_variable(chosen: Preset, base_url: str) -> str:
    """The variable in which users of this preset keep its key; "" where the address is not the preset's own.

    A key that was meant for one service must not go to another.
    """
    try:
        same = urlsplit(base_url.strip()).hostname == chosen.host and base_url.strip().startswith("https://")
    except ValueError:
        same = False
    return chosen.key_variable if same else ""
