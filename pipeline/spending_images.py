# SPDX-License-Identifier: GPL-3.0-or-later
"""What painted images cost, held against the room's cap like questions. Thread-safe."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

from .errors import Cancelled, ModelError
from .models.addresses import is_local_url
from .models.image_base import ImageClient, ImageRequest, PaintedImage
from .models.image_registry import ImageSettings
from .spending_meter import Meter


class CappedPainter:
    """An image client whose every image is priced before it is asked for and counted after it was painted.

    Args:
        inner: who paints; price: US dollars for one image, None when not known.
    """

    def __init__(self, inner: ImageClient, meter: Meter, price: float | None) -> None:
        self.inner, self.meter, self._price = inner, meter, price
        self.name, self.describes = inner.name, inner.describes

    def paint(
        self, request: ImageRequest, cancel: threading.Event, progress: Callable[[str], None] | None = None
    ) -> PaintedImage:
        """As `ImageClient.paint`; the image's `cost` is filled in where the price is known.

        Raises:
            SpendingError: it would pass the cap, or there is a cap and the price is not known. Nothing was sent.
        """
        fix = "Set the price of an image in the preferences, or set the cap to 0."
        with self.meter.request(self._price, "The price of an image", fix, progress) as spending:
            try:
                made = self.inner.paint(request, cancel, spending.tell)
            except (Cancelled, ModelError) as error:
                if spending.is_billed(error):
                    spending.spent = spending.reserved
                raise
            if made.cost is None and self._price is not None:
                made = replace(made, cost=self._price)
            spending.spent = made.cost or 0.0
            return made


def metered_painter(client: ImageClient | None, settings: ImageSettings, meter: Meter) -> ImageClient | None:
    """The image client with every image priced and held against the cap; None for no image model."""
    if client is None:
        return None
    free = is_local_url(settings.base_url)
    return CappedPainter(client, meter, 0.0 if free else settings.price or None)
