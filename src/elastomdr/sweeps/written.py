"""What zarr has written to a store. It imports zarr, so it is imported when needed."""

from __future__ import annotations

import zlib
from collections.abc import Iterable

from zarr.abc.store import Store
from zarr.core.buffer import Buffer
from zarr.storage import WrapperStore


class Written(WrapperStore[Store]):
    """A store that knows the checksums of what is written through it, so that nothing
    has to be read again for them.
    """

    def __init__(self, store: Store):
        super().__init__(store)
        # by file: size and CRC-32, or None of one that was deleted
        self.checksums: dict[str, list[int] | None] = {}

    async def set(self, key: str, value: Buffer) -> None:
        content = value.to_bytes()
        await super().set(key, value)
        self.checksums[key] = checksum(content)

    async def set_if_not_exists(self, key: str, value: Buffer) -> None:
        await super().set_if_not_exists(key, value)
        self.checksums.pop(key, None)

    async def _set_many(self, values: Iterable[tuple[str, Buffer]]) -> None:
        for key, value in values:
            await self.set(key, value)

    async def delete(self, key: str) -> None:
        await super().delete(key)
        self.checksums[key] = None


def checksum(content: bytes) -> list[int]:
    """Size and CRC-32."""
    return [len(content), zlib.crc32(content)]
