"""From pictures to where hands and objects are."""
