"""From pictures to hands and objects."""
