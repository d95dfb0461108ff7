"""From a camera to intentions: stages in threads of their own, merged into one stream."""
