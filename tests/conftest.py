"""Settings of the whole suite: hypothesis draws the same examples every time and never fails for slowness."""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "softcradle", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
settings.load_profile("softcradle")
