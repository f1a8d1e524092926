"""Share the analytic scene of the corruption tests."""

from tests.corruptions.conftest import scene

__all__ = ["scene"]
