"""Losses of variational autoencoders."""

from __future__ import annotations

from torch import Tensor


def kl_divergence(mean: Tensor, log_variance: Tensor) -> Tensor:
    """KL divergence (B,) of normal distributions from the standard one, nats.

    Source: Kingma and Welling, "Auto-Encoding Variational Bayes" (2014), appendix B.
    """
    return 0.5 * (mean.square() + log_variance.exp() - 1 - log_variance).sum(-1)


def node_terms(decoded: Tensor, features: Tensor, mean: Tensor, log_variance: Tensor) -> dict[str, Tensor]:
    """What an autoencoder of nodes loses: ``mse``, the mean over channels, and ``kl``, the mean over nodes.

    Parameters
    ----------
    decoded, features
        (N, C): what came out and what went in.
    mean, log_variance
        (N, latent): of the codes.
    """
    return {"mse": (decoded - features).square().mean(), "kl": kl_divergence(mean, log_variance).mean()}
