# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks at program text before Python's parser sees it, so that no text can exhaust the parser or hide what it says.

The parser's stack and memory grow with nesting and with the length of one expression; both are limited here by a walk
over the tokens that needs no recursion. Letters outside ASCII are refused everywhere but in strings and comments, as
they can look like others.
"""

from __future__ import annotations

import re
import unicodedata

from ..errors import ProgramError
from .limits import Limits

TOKEN = re.compile(
    r"""
    (?P<comment>\#[^\n]*)
  | (?P<string>[A-Za-z]{0,2}(?:
        '''[^'\\]*(?:(?:\\.|'(?!''))[^'\\]*)*'''
      | \"""[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*\"""
      | '(?!'')[^'\\\n]*(?:\\.[^'\\\n]*)*'
      | "(?!"")[^"\\\n]*(?:\\.[^"\\\n]*)*"))
  | (?P<number>(?:0[xX][0-9a-fA-F_]+|0[bB][01_]+|0[oO][0-7_]+
      |(?:[0-9][0-9_]*\.?[0-9_]*|\.[0-9][0-9_]*)(?:[eE][+-]?[0-9][0-9_]*)?)[jJ]?)
  | (?P<name>[A-Za-z_][A-Za-z0-9_]*)
  | (?P<space>[ \t\f]+|\\\n)
  | (?P<newline>\n|;)
  | (?P<open>[(\[{])
  | (?P<close>[)\]}])
  | (?P<comma>,)
  | (?P<operator>\*\*|//|:=|[-+*/%@&|^~<>=!.])
  | (?P<colon>:)
  | (?P<other>.)
    """,
    re.VERBOSE | re.DOTALL,
)
OPERATOR_WORDS = frozenset({"and", "or", "not", "in", "is", "if", "else", "for", "lambda", "await", "yield", "from"})
CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")
SURROGATE = re.compile(r"[\ud800-\udfff]")
DIRECTION = re.compile(r"[\u202a-\u202e\u2066-\u2069]")
ESCAPE = re.compile(r"\\(.)([0-7]{0,2})", re.DOTALL)
ESCAPES = frozenset("\n\\'\"abfnrtv01234567xNuU")
FIELD_OPERATOR = re.compile(r"[-+*/%@&|^~<>=!.(\[{]|\b(?:and|or|not|in|is|if|else|for|lambda|await)\b")
MOST_DIGITS = 40
MOST_FIELD_CHARACTERS = 2000


def normal_text(text: str, limits: Limits) -> str:
    """The text with plain line ends and without a byte order mark. Raises ProgramError for what no program holds."""
    if not isinstance(text, str):
        raise ProgramError("a program is text")
    if len(text) > limits.text_bytes:
        raise ProgramError(
            f"the program is longer than {limits.text_bytes:,} bytes", 0, "Write it shorter, with loops."
        )
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    for pattern, what in (
        (SURROGATE, "a broken character (half of a surrogate pair)"),
        (CONTROL, "a control character"),
        (DIRECTION, "an invisible character that turns the direction of text"),
    ):
        found = pattern.search(text)
        if found:
            raise ProgramError(f"the program holds {what}", text.count("\n", 0, found.start()) + 1, "Leave it out.")
    if len(text.encode()) > limits.text_bytes:
        raise ProgramError(
            f"the program is longer than {limits.text_bytes:,} bytes", 0, "Write it shorter, with loops."
        )
    return text


class Scanner:
    """Walks the tokens of one text and refuses what would be too much for the parser."""

    def __init__(self, text: str, limits: Limits) -> None:
        self.text = text
        self.limits = limits
        self.operators = [0]
        self.lambdas = [0]

    def refusal(self, position: int, message: str, fix: str = "") -> ProgramError:
        """A ProgramError with the line of a position in the text."""
        return ProgramError(message, self.text.count("\n", 0, position) + 1, fix)

    def run(self) -> None:
        """Raise ProgramError at the first token that is refused."""
        for match in TOKEN.finditer(self.text):
            kind = match.lastgroup
            if kind == "space" or kind == "comment" or kind == "colon":
                continue
            if kind == "name":
                if match.group() in OPERATOR_WORDS:
                    self.operator(match)
            elif kind == "comma":
                self.operators[-1] = 0
            elif kind == "newline":
                if len(self.operators) == 1:
                    self.operators[0] = self.lambdas[0] = 0
            elif kind == "open":
                self.operator(match)
                self.operators.append(0)
                self.lambdas.append(0)
                if len(self.operators) > self.limits.nesting + 1:
                    raise self.refusal(
                        match.start(), "brackets are nested too deeply", "Give parts of it a name in statements before."
                    )
            elif kind == "close":
                if len(self.operators) > 1:
                    self.operators.pop()
                    self.lambdas.pop()
            elif kind == "operator":
                self.operator(match)
            elif kind == "number":
                self.number(match)
            elif kind == "string":
                self.string(match)
            else:
                self.other(match)

    def operator(self, match: re.Match[str]) -> None:
        """Count an operator of the expression at hand."""
        self.operators[-1] += 1
        if match.group() == "lambda":
            self.lambdas[-1] += 1
        if self.operators[-1] > self.limits.operators or self.lambdas[-1] > self.limits.operators:
            raise self.refusal(
                match.start(), "an expression is too long", "Split it into several statements, or use a list and sum()."
            )

    def number(self, match: re.Match[str]) -> None:
        """Numbers have few digits and end where they end."""
        if match.end() - match.start() > MOST_DIGITS:
            raise self.refusal(match.start(), "a number has too many digits", f"Use at most {MOST_DIGITS}.")
        after = self.text[match.end() : match.end() + 1]
        if after.isalnum() or after == "_":
            raise self.refusal(match.start(), "a number and a name touch each other", "Put a space between them.")

    def string(self, match: re.Match[str]) -> None:
        """Escapes are known ones, and fields of f-strings are small."""
        token = match.group()
        prefix = re.match("[A-Za-z]*", token)
        letters = prefix.group().lower() if prefix else ""
        if "\\" in token and "r" not in letters:
            for escape in ESCAPE.finditer(token):
                letter, digits = escape.groups()
                if letter not in ESCAPES or (letter in "4567" and len(digits) == 2):
                    raise self.refusal(
                        match.start() + escape.start(),
                        f"\\{letter if letter.isprintable() else ''} is not an escape that strings know",
                        "Write \\\\ for a backslash.",
                    )
        if "f" in letters and "{" in token:
            body = token.replace("{{", "").replace("}}", "")
            if body.count("{") != body.count("}"):
                raise self.refusal(match.start(), "the braces of an f-string do not match", "Use other quotes inside.")
            if len(token) > MOST_FIELD_CHARACTERS or len(FIELD_OPERATOR.findall(body)) > self.limits.operators:
                raise self.refusal(match.start(), "an f-string is too long", "Split it into several.")

    def other(self, match: re.Match[str]) -> None:
        """A character that begins nothing."""
        character = match.group()
        if character in "'\"":
            raise self.refusal(match.start(), "a string is not closed", "Close it with the same quote.")
        if ord(character) > 127:
            name = unicodedata.name(character, f"U+{ord(character):04X}")
            raise self.refusal(
                match.start(),
                f"the character {name} is not allowed outside strings and comments",
                "Use plain ASCII letters, digits and signs.",
            )
        raise self.refusal(match.start(), f"the character {character} is not in the room language")
