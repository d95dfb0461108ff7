"""An open benchmark: any estimator of reaching intention, over declared sets of reaches."""
