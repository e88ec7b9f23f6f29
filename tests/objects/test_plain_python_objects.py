# SPDX-License-Identifier: GPL-3.0-or-later
"""What a strong model plausibly writes in an object's function makes what plain Python makes of it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from code_as_room.pipeline.errors import ProgramError
from code_as_room.pipeline.objects.mending import mended
from code_as_room.pipeline.program.evaluate import evaluate_object
from code_as_room.pipeline.program.prelude import registry
from code_as_room.pipeline.program.prelude.shape import Shape, flat_shapes

PLAUSIBLE: dict[str, str] = {
    "reversed": 'x = [box((v, 1, 1)) for v in reversed([1, 2])]',
    "enumerate start": 'x = [box((i, v, 1)) for i, v in enumerate([1, 2], start=1)]',
    "zip star": 'pairs = [(1, 2), (3, 4)]\nxs, ys = zip(*pairs)\nx = box((xs[0], ys[1], 1))',
    "sorted key": 'x = box(tuple(sorted((3, 1, 2), key=lambda v: -v)))',
    "sum gen": 'x = box((sum(v for v in (1, 2)), min(v for v in (1, 2)), max((1, 2), key=lambda v: v)))',
    "gen in gen with start": 'x = box((sum((v for v in (1, 2)), 0), 1, 1))',
    "max default gen": 'x = box((max((v for v in ()), default=1), 1, 1))',
    "fstring": "x = [part(f'leg_{i}', box((1, 1, 1))) for i in range(2)]",
    "fstring fmt": "x = [part(f'leg_{i:02d}', box((1, 1, 1))) for i in range(2)]",
    "fstring conv": "n = 'a'\nx = part(f'leg {n!s}', box((1, 1, 1)))",
    "percent": "x = part('leg_%d' % 3, box((1, 1, 1)))",
    "str format": "x = part('leg_{}'.format(3), box((1, 1, 1)))",
    "str format 2": "x = part('leg_{0}_{1:.1f}'.format(3, 2.5), box((1, 1, 1)))",
    "startswith": "x = box((1 if 'leg_a'.startswith('leg') else 2, 1, 1))",
    "math": 'import math\nx = box((math.sqrt(4), math.cos(math.radians(60)), math.pi))',
    "math as": 'import math as m\nx = box((m.sqrt(4), m.tau, 1))',
    "from math as": 'from math import sqrt as root, pi as PI\nx = box((root(4), PI, 1))',
    "from math": 'from math import sin, cos, pi\nx = box((cos(0), 1, pi))',
    "math more": 'import math\nx = box((math.dist((0, 0), (3, 4)), math.log10(100), math.trunc(2.7)))',
    "unpack loop": 'x = [box((a, b, c)) for i, (a, (b, c)) in enumerate([(1, (2, 3))])]',
    "multi for": 'x = [box((a, b, 1)) for a in (1, 2) for b in (1, 2) if a != b]',
    "cond expr": 'x = box((1 if size[0] > 0.5 else 2, 1, 1))',
    "dict lookup": "d = {'a': 1}\nx = box((d['a'], 1, 1))",
    "dict get": "d = {'a': 1}\nx = box((d.get('a', 3), d.get('b', 2), 1))",
    "dict get none": "d = {'a': 1}\nv = d.get('b')\nx = box((1 if v is None else 2, 1, 1))",
    "dict items": "d = {'a': 1}\nx = [part(k, box((v, 1, 1))) for k, v in d.items()]",
    "dict update": "d = {'a': 1}\nd.update({'b': 2})\nx = box((d['b'], 1, 1))",
    "dict merge": "d = {'a': 1}\ne = {**d, 'b': 2}\nx = box((e['a'], e['b'], 1))",
    "kw only call": 'def leg(*, r, h):\n    return cylinder(r, h)\nx = leg(r=0.1, h=1)',
    "kw only default": 'def leg(h, *, r=0.1):\n    return cylinder(r, h)\nx = leg(1)',
    "posonly": 'def leg(h, /, r=0.1):\n    return cylinder(r, h)\nx = leg(1)',
    "varargs": 'def both(*shapes):\n    return list(shapes)\nx = both(box((1, 1, 1)), box((2, 1, 1)))',
    "kwargs call": 'kw = dict(segments=8, at=(0, 0, 1))\nx = cylinder(0.1, 1, **kw)',
    "early return": 'def leg(h):\n    if h > 0.5:\n        return cylinder(0.1, h)\n    return box((1, 1, h))\nx = [leg(1), leg(0.2)]',
    "docstring": 'def leg(h):\n    """A leg.\n\n    More.\n    """\n    return cylinder(0.1, h)\nx = leg(1)',
    "annotations": "def leg(h: float, n: int = 3, p: tuple[float, float] = (0, 0)) -> 'Shape':\n    return cylinder(0.1, h)\nr: float = 2.0\ns: int\nx = leg(1)",  # noqa: E501
    "optional ann": 'def leg(h: float | None = None) -> list:\n    h = h or 1\n    return cylinder(0.1, h)\nx = leg()',
    "typing import": 'from typing import List, Tuple\ndef leg(h: float) -> List[int]:\n    return cylinder(0.1, h)\nx = leg(1)',
    "while": 'i = 0\nx = []\nwhile i < 3:\n    x.append(box((1, 1, 1), at=(i, 0, 0)))\n    i += 1',
    "while true": 'i = 0\nx = []\nwhile True:\n    x.append(box((1, 1, 1), at=(i, 0, 0)))\n    i += 1\n    if i >= 3:\n        break',
    "while continue": 'i = 0\nn = 0\nwhile i < 5:\n    i += 1\n    if i % 2:\n        continue\n    n += i\nx = box((n, 1, 1))',
    "assert raise": "if size[0] < 0:\n    raise ValueError('no')\nassert size[1] > 0, 'no'\nx = box((1, 1, 1))",
    "try": 'try:\n    w = 1 / size[0]\nexcept ZeroDivisionError:\n    w = 2\nx = box((w, 1, 1))',
    "star unpack": 'a, *rest = (1, 2, 3)\nx = box((a, rest[0], rest[1]))',
    "star unpack 2": '*rest, a = (1, 2, 3)\nx = box((a, rest[0], rest[1]))',
    "star in list": 'more = [box((1, 1, 1))]\nx = [*more, box((2, 1, 1))]',
    "set literal": 'x = box((1 if 3 in {1, 3} else 2, 1, 1))',
    "set call": 'x = box((len(set([1, 1, 2])), 1, 1))',
    "set comp": 'x = box((len({v % 2 for v in range(5)}), 1, 1))',
    "frozenset": 'S = frozenset((1, 2))\nx = box((2 if 2 in S else 1, 1, 1))',
    "map": 'x = box(tuple(map(float, (1, 2, 3))))',
    "map lambda": 'x = list(map(lambda v: box((v, 1, 1)), (1, 2)))',
    "filter": 'x = [box((v, 1, 1)) for v in filter(lambda v: v > 1, (1, 2))]',
    "divmod": 'q, r = divmod(7, 3)\nx = box((q, r, 1))',
    "abs round": 'x = box((abs(-1), round(1.26, 1), int(2.7)))',
    "slice": 'p = [1, 2, 3, 4]\nx = box(tuple(p[1:]))',
    "insert": 'p = [1, 2]\np.insert(0, 3)\nx = box(tuple(p))',
    "sort": 'p = [3, 1, 2]\np.sort()\nx = box(tuple(p))',
    "sort key": 'p = [3, 1, 2]\np.sort(key=lambda v: -v, reverse=True)\nx = box(tuple(p))',
    "reverse": 'p = [3, 1, 2]\np.reverse()\nx = box(tuple(p))',
    "extend": 'x = []\nx.extend(box((v, 1, 1)) for v in (1, 2))',
    "extend call": 'x = []\nx.extend(array(box((1, 1, 1)), 2, (2, 0, 0)))',
    "iadd": 'x = []\nx += [box((1, 1, 1))]',
    "iadd shape": 'x = []\nx += [box((1, 1, 1))] + [box((2, 1, 1))]',
    "copy": 'a = [1, 2, 3]\nb = a.copy()\nx = box(tuple(b))',
    "in op": "x = box((1 if 'a' in 'abc' and 2 not in (1, 3) else 5, 1, 1))",
    "chained": 'x = box((1 if 0 < size[0] <= 5 else 2, 1, 1))',
    "is true": 'flag = True\nx = box((1 if flag is True else 2, 1, 1))',
    "is not": "a = 'x'\nx = box((1 if a is not None else 2, 1, 1))",
    "bit": 'x = [box((1, 1, 1), at=(i, 0, 0)) for i in range(4) if i & 1]',
    "shift": 'x = box((1 << 2, 5 >> 1, 1))',
    "lambda": 'leg = lambda a, b=1: box((a, b, 1))\nx = [leg(1), leg(2, b=3)]',
    "nested def closure": "parts = []\ndef add(n, s):\n    parts.append(part(n, s))\nadd('a', box((1, 1, 1)))\nadd('b', box((1, 1, 1)))\nx = parts",  # noqa: E501
    "yield": 'def legs():\n    for v in (1, 2):\n        yield box((v, 1, 1))\nx = list(legs())',
    "yield from": 'def legs():\n    yield from [box((1, 1, 1)), box((2, 1, 1))]\nx = list(legs())',
    "global const": 'LEG = 2\nx = box((LEG, 1, 1))',
    "itertools": 'import itertools\nx = [box((a, b, 1)) for a, b in itertools.product((1, 2), (1, 3))]',
    "from itertools": 'from itertools import product\nx = [box((a, b, 1)) for a, b in product((1, 2), repeat=2)]',
    "chain": 'from itertools import chain\nx = list(chain([box((1, 1, 1))], [box((2, 1, 1))]))',
    "linspace": 'import numpy as np\nx = [box((v, 1, 1)) for v in np.linspace(1, 2, 3)]',
    "np funcs": 'import numpy as np\nx = box((np.pi, np.sqrt(4), np.cos(0)))',
    "np clip": 'import numpy as np\nx = box((np.clip(3.0, 0, 2), np.deg2rad(90), 1))',
    "ellipsis": 'def nothing():\n    ...\nx = box((1, 1, 1))',
    "main guard": "x = box((1, 1, 1))\nif __name__ == '__main__':\n    print(x)",
    "underscore var": '_w = 2\nx = box((_w, 1, 1))',
    "underscore def": 'def _leg(h):\n    return box((h, 1, 1))\nx = _leg(1)',
    "dunder loop": 'x = [box((1, 1, 1)) for _ in range(2)]\nfor __ in range(2):\n    x.append(box((1, 1, 1)))',
    "for else": 'for i in range(3):\n    if i > 5:\n        break\nelse:\n    i = 2\nx = box((i, 1, 1))',
    "aug mul": 'w = 2\nw *= 2\nw -= 1\nw /= 2\nw //= 1\nx = box((w, 1, 1))',
    "multi assign": 'a = b = 1\nc, d = d0 = (2, 3)\nx = box((a, c, d))',
    "tuple add": 'p = (1, 2) + (3,)\nx = box(p)',
    "neg index": 'p = (1, 2, 3)\nx = box((p[-1], p[-2], 1))',
    "return tuple": 'x = (box((1, 1, 1)), box((2, 1, 1)))',
    "fstring nested quotes": 'd = {\'a\': 1}\nx = part(f"leg {d[\'a\']}", box((1, 1, 1)))',
    "string concat": "x = part('leg' + str(1) + '_' 'b', box((1, 1, 1)))",
    "int div": 'x = box((7 // 2, 7 % 4, 2 ** 2))',
    "float inf": "m = float('inf')\nfor v in (3, 1):\n    m = min(m, v)\nx = box((m, 1, 1))",
    "math inf": 'import math\nm = math.inf\nfor v in (3, 1):\n    m = min(m, v)\nx = box((m, 1, 1))',
    "any all": 'x = box((1 if any(v > 1 for v in (1, 2)) and all(v for v in (1, 2)) else 3, 1, 1))',
    "tuple gen": 'x = box(tuple(v for v in (1, 2, 3)))',
    "nested comps": 'x = [[box((a, b, 1)) for a in (1, 2)] for b in (1, 2)]',
    "dict comp": "d = {k: v for k, v in zip('ab', (1, 2))}\nx = box((d['a'], d['b'], 1))",
    "dict call": "d = dict(a=1)\nx = box((d['a'], 1, 1))",
    "dict zip": "d = dict(zip('ab', (1, 2)))\nx = box((d['a'], d['b'], 1))",
    "list mul": 'p = [1] * 3\nx = box(tuple(p))',
    "range neg": 'x = [box((v, 1, 1)) for v in range(3, 0, -1)]',
    "len": 'x = [box((1, 1, len(size)))]',
    "default tuple": 'def thing2(size=(1, 1, 1), n=2):\n    w, d, h = size\n    return box((w, d, h))\nx = thing2()',
    "ignored param": 'def leg(h, _unused=None):\n    return box((h, 1, 1))\nx = leg(1)',
    "pass": 'for i in range(2):\n    pass\nx = box((1, 1, 1))',
    "multi line str": "x = part('a'\n    'b', box((1, 1, 1)))",
    "namedtuple size": 'w, d, h = map(float, size)\nx = box((1, 1, 1))',
    "sum lists": 'x = sum([[box((1, 1, 1))], [box((2, 1, 1))]], [])',
    "str mult": "x = part('a' * 2, box((1, 1, 1)))",
    "conditional append": 'x = []\nx.append(box((1, 1, 1))) if size[0] > 0.1 else None\n',
    "comprehension append": 'x = []\n[x.append(box((v, 1, 1))) for v in (1, 2)]',
    "alias": 'B = box\nx = B((1, 1, 1))',
    "complex tern in at": 'x = [box((1, 1, 1), at=(s * 0.5, (1 if t else -1) * 0.5, 0)) for s, t in ((1, True), (-1, False))]',
    "type hints lambda": 'from typing import Callable\nf: Callable[[float], float] = lambda v: v * 2\nx = box((f(1), 1, 1))',
    "min tuple": 'x = box((min(size), max(size[0], 2), min(*size)))',
    "hex": "c = '#' + 'AA' * 3\nx = part('a', box((1, 1, 1)), material='wood ' + c)",
    "print debug": "print('w', size)\nx = box((1, 1, 1))",
    "unpack in def": 'def leg(p, h):\n    (a, b) = p\n    return box((a, b, h))\nx = leg((1, 2), 3)',
    "math e": 'import math\nx = box((math.e, math.copysign(1, 2), 1))',
    "math own e": 'from math import e as euler\ne = 2\nx = box((e, euler, 1))',
    "kwargs twice": "soft = {'segments': 8}\nx = [cylinder(0.1, 1, **soft), sphere(0.2, **soft)]",
    "default float arg swap": 'x = cylinder(0.1, 1, 0.01, at=(0, 0, 1))',
    "stars with first": "def both(n, *shapes):\n    return [part(n, s) for s in shapes]\nx = both('a', box((1, 1, 1)), box((2, 1, 1)))",
    "sort keeps the list": 'a = [3, 1, 2]\nb = a\nb.sort()\nx = box(tuple(a))',
    "insert at end": 'p = [1, 2]\np.insert(9, 3)\nx = box(tuple(p))',
    "yield returns": 'def legs(n):\n    for v in range(9):\n        if v >= n:\n            return\n        yield box((v + 1, 1, 1))\nx = [*legs(2)]',  # noqa: E501
    "try import": 'try:\n    import numpy as np\nexcept ImportError:\n    np = None\nx = box((1, 1, 1))',
    "nested while": 'i = 0\nx = []\nwhile i < 2:\n    j = 0\n    while j < 2:\n        x.append(box((1, 1, 1), at=(i, j, 0)))\n        j += 1\n    i += 1',  # noqa: E501
}  # fmt: skip
"""The body of a def that leaves its shapes in x."""

REFUSED: dict[str, str] = {
    "recursion": "def f(n):\n    return 1 if n <= 0 else n * f(n - 1)\nx = box((f(2), 1, 1))",
    "class": "class Leg:\n    h = 1\nx = box((Leg.h, 1, 1))",
    "endless": "while True:\n    pass",
    "endless count": "i = 0\nwhile i < 1:\n    i -= 1",
    "attribute of a module": "import os\nx = os.getcwd()",
    "builtins": "x = __builtins__",
    "own builtins": "x = [c for c in ().__class__.__mro__]",
    "alias of import": "import numpy as np\nx = np.load('a')",
    "get of anything": "x = globals().get('a')",
    "format of attributes": "x = part('{0.__class__}'.format(1), box((1, 1, 1)))",
    "map of a builtin": "x = list(map(eval, ['1']))",
    "huge shift": "x = box((1 << 500, 1, 1))",
    "huge product": "r = range(1000000)\nx = [a for a, b, c in __import__('itertools').product(r, r, r)]",
}
"""What stays outside, however it is written."""


def program(body: str) -> str:
    lines = "\n".join(f"    {line}" for line in body.split("\n"))
    return f"def thing(size):\n{lines}\n    return x\n"


def by_python(text: str) -> list[Shape]:
    names: dict[str, Any] = {name: getattr(math, name) for name in registry.MATH}
    names |= {**registry.CONSTRUCTORS, **registry.CONSTANTS, "__name__": "room"}
    exec(compile(text, "room", "exec"), names)  # noqa: S102  (a text of our own, in a test)
    return flat_shapes("thing", names["thing"]((1.0, 1.0, 1.0)))


def by_us(text: str) -> list[Shape]:
    return evaluate_object(text, "thing", args=[(1.0, 1.0, 1.0)])


def same(found: list[Shape], wanted: list[Shape]) -> None:
    assert [(s.part, s.material) for s in found] == [(s.part, s.material) for s in wanted]
    for a, b in zip(found, wanted, strict=True):
        np.testing.assert_allclose(a.vertices, b.vertices, atol=1e-12)


@pytest.mark.parametrize("name", PLAUSIBLE)
def test_it_makes_what_python_makes(name: str) -> None:
    text = program(PLAUSIBLE[name])
    wanted = by_python(text)
    assert wanted
    try:
        same(by_us(text), wanted)
    except ProgramError:
        rewritten = mended(text)
        assert rewritten is not None
        same(by_us(rewritten), wanted)
        same(by_python(rewritten), wanted)  # room.py has the rewritten text


@pytest.mark.parametrize("name", REFUSED)
def test_everything_else_is_refused(name: str) -> None:
    text = program(REFUSED[name])
    with pytest.raises(ProgramError):
        by_us(mended(text) or text)
