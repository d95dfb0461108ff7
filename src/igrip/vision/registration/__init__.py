"""From depth to poses: the plane, what stands on it, and which mesh fits it how."""
