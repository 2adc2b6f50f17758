"""What zarr has written to a store."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from zarr.abc.store import Store
    from zarr.core.buffer import Buffer


def remembered(store: Store) -> Any:
    """The same store, which keeps `checksums` of what is written through it, so that
    nothing has to be read again for them.
    """
    from zarr.storage import WrapperStore

    class Written(WrapperStore[Any]):
        # by file: size and CRC-32, or None of one that was deleted
        checksums: dict[str, list[int] | None]

        async def set(self, key: str, value: Buffer) -> None:
            await super().set(key, value)
            self.checksums[key] = checksum(value.to_bytes())

        async def set_if_not_exists(self, key: str, value: Buffer) -> None:
            await super().set_if_not_exists(key, value)
            self.checksums.pop(key, None)  # not known

        async def _set_many(self, values: Iterable[tuple[str, Buffer]]) -> None:
            for key, value in values:
                await self.set(key, value)

        async def delete(self, key: str) -> None:
            await super().delete(key)
            self.checksums[key] = None

    written = Written(store)
    written.checksums = {}
    return written


def checksum(content: bytes) -> list[int]:
    """Size and CRC-32."""
    return [len(content), zlib.crc32(content)]
