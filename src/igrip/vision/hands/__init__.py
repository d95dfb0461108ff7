"""Hand finders: from a picture to the landmarks of hands, found by name."""
