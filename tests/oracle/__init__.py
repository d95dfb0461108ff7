"""An independent oracle: what the paper and docs/decisions say, in slow and plain float64 numpy.

Nothing here imports igrip. Where igrip uses closed forms, trees and compiled loops, the oracle uses
``np.linalg.lstsq``, ``scipy.spatial.transform.Rotation`` and every triangle of every mesh.
"""
