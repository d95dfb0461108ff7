"""What learned estimators of the target share: features, networks, a library of reaches."""
