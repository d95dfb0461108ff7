"""Where and how an object can be grasped, by the geometry of its mesh.

``surface ► opposition ► hand_fit ► classify ► clusters ► candidates``: a smoothed sample of the
surface; opposing contacts within the opening of a hand; directions from which a hand fits round
them; the grip that fits; a few candidates of each; kept on disk with what the user declares.
"""
