"""A CosyPose server for igrip: run it in HappyPose's own Python (docs/cosypose.md).

``python server.py --port 8768``. It needs HappyPose, its YCB-Video weights and meshes, and nothing
of igrip. One client at a time; a reply is sent before the next frame is read.
"""

import argparse
import json
import socketserver
import struct
import sys
import traceback

import numpy as np

PROTOCOL = "igrip-poses/1"
MAX_HEADER = 1 << 16  # bytes
MAX_PIXELS = 1 << 24


def estimator(threshold, workers):
    """Return a function from colour, depth and camera matrix to poses, after loading CosyPose."""
    import torch
    from happypose.pose_estimators.cosypose.cosypose.utils.cosypose_wrapper import CosyPoseWrapper
    from happypose.toolbox.inference.types import ObservationTensor

    device = "cuda" if torch.cuda.is_available() else "cpu"
    cosypose = CosyPoseWrapper(dataset_name="ycbv", model_type="synth+real", n_workers=workers)

    def estimate(colour, depth, matrix):
        observation = ObservationTensor.from_numpy(colour, depth, matrix).to(device)
        results, _ = cosypose.pose_predictor.run_inference_pipeline(
            observation,
            run_detector=True,
            detection_th=threshold,
            n_coarse_iterations=1,
            n_refiner_iterations=4,
        )
        if results is None or len(results.infos) == 0:
            return []
        poses = results.poses.detach().cpu().numpy()
        return [
            {
                "label": str(info.label),
                "score": float(info.score),
                "camera_from_object": np.asarray(pose, dtype=float).tolist(),
            }
            for info, pose in zip(results.infos.itertuples(), poses)  # noqa: B905 (Python 3.9)
        ]

    return estimate


class Client(socketserver.StreamRequestHandler):
    """Replies to the frames of one client until it disconnects."""

    def handle(self):
        """Read frames and write replies."""
        while True:
            length = self.rfile.read(4)
            if len(length) < 4:
                return
            (length,) = struct.unpack(">I", length)
            if length > MAX_HEADER:
                return
            header = json.loads(self.rfile.read(length))
            height, width = int(header["height"]), int(header["width"])
            if header["schema"] != PROTOCOL or not 0 < height * width <= MAX_PIXELS:
                return
            pixels = self.rfile.read(height * width * 3)
            colour = np.frombuffer(pixels, np.uint8).reshape(height, width, 3).copy()
            depth = None
            if header["depth"]:
                read = self.rfile.read(height * width * 4)
                depth = np.frombuffer(read, "<f4").reshape(height, width).copy()
            try:
                poses = self.server.estimate(colour, depth, np.array(header["matrix"]))
                answer = {"seq": header["seq"], "poses": poses}
            except Exception as error:  # the client gets the message, and the next frame may do
                traceback.print_exc()
                answer = {"seq": header["seq"], "error": f"{type(error).__name__}: {error}"}
            packed = json.dumps(answer).encode()
            self.wfile.write(struct.pack(">I", len(packed)) + packed)


class Server(socketserver.TCPServer):
    """Holds the estimator."""

    allow_reuse_address = True

    def __init__(self, address, estimate):
        super().__init__(address, Client)
        self.estimate = estimate

    def handle_error(self, request, client_address):
        """Print why a client was dropped; the next may come."""
        print(f"client {client_address[0]}: {sys.exc_info()[1]}", file=sys.stderr)


def main():
    """Load CosyPose, then listen."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=8768)
    parser.add_argument("--threshold", type=float, default=0.7, help="of the detector")
    parser.add_argument("--workers", type=int, default=2, help="of the renderer")
    options = parser.parse_args()
    estimate = estimator(options.threshold, options.workers)
    with Server((options.host, options.port), estimate) as server:
        print(f"ready on {options.host}:{options.port}", flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main()
