"""A simulated user of the page, without a browser."""

import asyncio
import time

# what is computed for the cards is stopped by all else; Python may drop a stop, which is
# repeated then, and say so
STOPPED = "ignore:(?s).*CancelledError:pytest.PytestUnraisableExceptionWarning"


def simulated(tmp_path, act):
    """Runs `act(user, page, again)` with a simulated user on the page; `again` opens
    the same or another session.
    """
    from nicegui import background_tasks
    from nicegui.testing.user_simulation import user_simulation

    from elastomdr.app.page import page
    from elastomdr.app.session import Sessions

    sessions, pages = Sessions(tmp_path), []

    async def all_of_it():
        async with user_simulation(root=lambda: pages.append(page(sessions))) as user:

            async def opened(address="/"):
                await user.open(address)
                return pages[-1]

            try:
                await act(user, await opened(), opened)
            finally:
                for task in list(background_tasks.running_tasks):
                    task.cancel()

    asyncio.run(all_of_it())


async def until(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        await asyncio.sleep(0.02)
