"""Make the analytic scene of the corruption tests available."""

from tests.corruptions.conftest import scene

__all__ = ["scene"]
