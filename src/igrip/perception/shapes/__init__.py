"""Things without a model: segmented, fitted with simple shapes, and made into models."""
