# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps as nodes: patterns in metres on the UVs or in the object's own space, and what is made of them."""

from __future__ import annotations

from typing import Any

from ...program.prelude.looks import UNKNOWN
from ...program.prelude.maps import Map, linear
from ..pictures import ensure_image
from .sockets import new_node, out

_APART = (7.3, 5.1, 3.7)  # metres between the patterns of two objects, at most
_BOARD = (3.1, 1.7, 2.3)  # and of two boards of one floor
_TILE_EDGE = 0.35


class Patterns:
    """Makes the nodes of maps in a tree; equal maps share theirs."""

    def __init__(self, tree: Any) -> None:
        self.tree = tree
        self._made: dict[Any, Any] = {}

    def value(self, value: Any) -> Any:
        """The output that gives a map; numbers and linear colours as they are."""
        if not isinstance(value, Map):
            return value
        if value not in self._made:
            self._made[value] = getattr(self, f"_{value.kind}")(dict(value.values))
        return self._made[value]

    def _node(self, kind: str, inputs: dict[str, Any] | None = None, **settings: Any) -> Any:
        return new_node(self.tree, kind, inputs, **settings)

    def _once(self, key: Any, make: Any) -> Any:
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]

    def _random(self) -> Any:
        """A number of its own for each object, the same in every render."""
        return self._once("random", lambda: out(self._node("ObjectInfo"), "Random"))

    def _places(self, space: str, loose: bool) -> Any:
        """Coordinates in metres."""
        node = self._once("places", lambda: self._node("TexCoord"))
        places = out(node, "UV" if space == "uv" else "Object")
        if not loose:
            return places
        return self._once(("loose", space), lambda: self._moved(places, self._random(), _APART))

    def _moved(self, places: Any, by: Any, far: tuple[float, float, float]) -> Any:
        """Coordinates moved by a number times a distance."""
        node = self._node("VectorMath", operation="MULTIPLY_ADD")
        for target, value in zip(node.inputs, (by, far, places), strict=False):
            if isinstance(value, tuple):
                target.default_value = value
            else:
                self.tree.links.new(value, target)
        return out(node, "Vector")

    def _scaled(self, values: dict[str, Any]) -> dict[str, Any]:
        """Where a pattern looks, with its stretch."""
        places = self._places(values["space"], values.get("loose", False))
        if "each" in values:
            places = self._once(
                ("each", values["space"]), lambda: self._moved(places, self.value(values["each"]), _BOARD)
            )
        stretch = values["stretch"]
        if stretch != (1, 1, 1):
            factors = tuple(1 / s for s in stretch)
            node = self._once(
                ("stretch", places, stretch),
                lambda: self._node("Mapping", {"Vector": places, "Scale": factors}, vector_type="POINT"),
            )
            places = out(node, "Vector")
        return {"Vector": places, "Scale": 1 / values["size"]}

    def _noise(self, values: dict[str, Any]) -> Any:
        inputs = {"Detail": values["detail"], "Roughness": values["rough"], "Distortion": values["distortion"]}
        node = self._node("TexNoise", {**self._scaled(values), **inputs}, noise_dimensions="3D")
        return out(node, "Fac") or out(node, "Factor")

    def _wave(self, values: dict[str, Any]) -> Any:
        style, axis = values["style"].upper(), values["axis"].upper()
        place = self._scaled(values)
        # One of Blender's waves is 2 pi / 20 long.
        inputs = {"Vector": place["Vector"], "Scale": place["Scale"] * 0.314159, "Distortion": values["distortion"],
                  "Detail": values["detail"], "Detail Scale": 1.5}  # fmt: skip
        settings = {"bands_direction" if style == "BANDS" else "rings_direction": axis}
        node = self._node("TexWave", inputs, wave_type=style, wave_profile="SIN", **settings)
        return out(node, "Fac") or out(node, "Factor")

    def _voronoi(self, values: dict[str, Any]) -> Any:
        inputs = {**self._scaled(values), "Randomness": values["random"]}
        edge = values["output"] == "edge"
        dimensions = "2D" if values["space"] == "uv" else "3D"
        feature = "DISTANCE_TO_EDGE" if edge else "F1"
        key = ("voronoi", feature, *((n, v) for n, v in values.items() if n != "output"))
        node = self._once(key, lambda: self._node("TexVoronoi", inputs, voronoi_dimensions=dimensions, feature=feature))
        return out(node, "Color" if values["output"] == "tone" else "Distance")

    def _brick(self, values: dict[str, Any]) -> Any:
        key = ("brick", *((n, v) for n, v in values.items() if n != "output"))
        node = self._once(key, lambda: self._brick_node(values))
        return out(node, "Color") if values["output"] == "tone" else out(node, "Fac") or out(node, "Factor")

    def _brick_node(self, values: dict[str, Any]) -> Any:
        long, wide = values["size"]
        places = self._places("uv", False)
        if values["turned"]:
            turn = self._node("Mapping", {"Vector": places, "Rotation": (0.0, 0.0, 1.5707963)}, vector_type="POINT")
            places = out(turn, "Vector")
        inputs = {
            "Vector": places, "Scale": 1.0, "Color1": (0.0, 0.0, 0.0), "Color2": (1.0, 1.0, 1.0), "Mortar": (0.5, 0.5, 0.5),
            "Mortar Size": values["gap"] / 2, "Mortar Smooth": values["soft"], "Bias": 0.0,
            "Brick Width": long, "Row Height": wide,
        }  # fmt: skip
        return self._node("TexBrick", inputs, offset=values["offset"], offset_frequency=2, squash=1.0)

    def _picture(self, values: dict[str, Any]) -> Any:
        # An image node without an image is black, or pink.
        image = ensure_image(values["name"], linear(values["color"] or UNKNOWN))
        places = self._places(values["space"], False)
        size = values["size"]
        if size is not None or values["turned"]:
            factors = (1.0, 1.0, 1.0) if size is None else (1 / size[0], 1 / size[1], 1.0)
            if values["turned"]:  # a texture turns one way when its places turn the other
                angle = (0.0, 0.0, -values["turned"] * 0.017453293)
                places = out(
                    self._node("Mapping", {"Vector": places, "Rotation": angle}, vector_type="POINT"), "Vector"
                )
            places = out(self._node("Mapping", {"Vector": places, "Scale": factors}, vector_type="POINT"), "Vector")
        node = self._node("TexImage", {"Vector": places}, extension="REPEAT" if size is not None else "EXTEND")
        node.image = image
        return out(node, "Color")

    def _ramp(self, values: dict[str, Any]) -> Any:
        stops = values["stops"]
        if len(stops) == 2 and not isinstance(stops[0][1], tuple):
            (low, first), (high, last) = stops
            inputs = {"Value": self.value(values["map"]), "From Min": low, "From Max": max(high, low + 1e-6),
                      "To Min": first, "To Max": last}  # fmt: skip
            return out(self._node("MapRange", inputs, clamp=True), "Result")
        node = self._node("ValToRGB", {"Fac": self.value(values["map"])})
        if not node.inputs[0].is_linked:
            self.tree.links.new(self.value(values["map"]), node.inputs[0])
        elements = node.color_ramp.elements
        while len(elements) > 1:
            elements.remove(elements[-1])
        for index, (place, value) in enumerate(stops):
            element = elements[0] if index == 0 else elements.new(place)
            element.position = place
            element.color = (*value, 1.0) if isinstance(value, tuple) else (value, value, value, 1.0)
        return out(node, "Color")

    def _mix(self, values: dict[str, Any]) -> Any:
        blend = values["mode"].upper()
        inputs = {"Factor_Float": values["by"], "A_Color": values["a"], "B_Color": values["b"]}
        node = self._node("Mix", {n: self.value(v) for n, v in inputs.items()}, data_type="RGBA", blend_type=blend)
        return out(node, "Result_Color")

    def _vary(self, values: dict[str, Any]) -> Any:
        """The map with a little more or less of it on each object."""
        amount = values["amount"]
        node = self._node("MapRange", {"Value": self._random(), "To Min": -amount, "To Max": amount})
        total = self._node("Math", operation="ADD")
        for target, value in zip(total.inputs, (self.value(values["map"]), out(node, "Result")), strict=False):
            self.tree.links.new(value, target)
        return out(total, "Value")

    def _bump(self, values: dict[str, Any]) -> Any:
        inputs = {"Strength": values["strength"], "Distance": abs(values["depth"]), "Height": self.value(values["map"])}
        return out(self._node("Bump", inputs, invert=values["depth"] < 0), "Normal")
