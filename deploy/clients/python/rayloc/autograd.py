"""The channel of a link as a function of torch, with the derivatives of the engine.

    h = rayloc.autograd.channel(values, link, ["tx.0", "tx.1"], grid)
    loss = (h - measured).abs().square().sum()
    loss.backward()                 # values.grad

Needs torch (Debian's python3-torch); nothing else of the package does.
"""

from __future__ import annotations

from typing import Any, Sequence

from rayloc.needs import explained

try:
    import numpy as np
    import torch
    from torch.autograd.function import once_differentiable

    from rayloc.tracing import Link, OfdmGrid, changed, trace
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["Channel", "channel"]


class Channel(torch.autograd.Function):
    """The function behind `channel`, for torch.autograd.

    Shapes: values (parameters,), the result (tones,).
    Units: metres, radians, S/m, or 1 of gains and eps_r.
    Frame: world, right-handed, z up.
    Errors: as rayloc.changed and rayloc.gradient raise them; ValueError in backward() where a gain
        is -1.
    Source: engine/trace/path_derivatives.h.
    """

    @staticmethod
    def forward(
        ctx: Any,
        values: Any,
        link: Link,
        parameters: Sequence[str],
        grid: OfdmGrid,
        options: dict[str, Any],
    ) -> Any:
        moved = changed(link, parameters, values.detach().cpu().double().numpy())
        ctx.paths = trace(moved.scene, moved.tx, moved.rx, **options)
        ctx.gain, ctx.parameters, ctx.grid = moved.gain, list(parameters), grid
        ctx.values = values.detach()
        return torch.from_numpy(moved.gain * ctx.paths.cfr(grid)).to(values.device)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, adjoint: Any) -> Any:
        # Torch's gradient of a real loss with respect to a complex h is g with dL = Re sum conj(g) dh.
        # A conjugate or negative view must be resolved before it becomes a numpy array.
        adjoint = adjoint.detach().resolve_conj().resolve_neg().cpu().numpy()
        g = np.ascontiguousarray(adjoint, dtype=np.complex128)
        derivatives = ctx.paths.derivatives(ctx.parameters)
        result = ctx.gain * derivatives.loss_gradient(ctx.grid, g)
        # The names of the derivatives: one given name may expand to several parameters.
        for i, name in enumerate(derivatives.names):
            if name in ("tx_gain", "rx_gain"):  # of a factor 1 + value, not of the one at 1
                factor = 1.0 + float(ctx.values[i])
                if factor == 0.0:
                    raise ValueError(f"{name} of -1 leaves no channel, so it has no gradient there")
                result[i] /= factor
        return torch.from_numpy(result).to(ctx.values), None, None, None, None


def channel(
    values: Any,
    link: Link,
    parameters: Sequence[str],
    grid: OfdmGrid,
    max_depth: int = 3,
    refraction: bool = False,
    softness: float = 0.0,
    diffraction: int = 0,
    diffuse_reflection: bool = False,
) -> Any:
    """The channel of a link of which some numbers are changed by a tensor.

    Args:
        values: a real tensor of torch, added to the parameters; its gradient is filled by
            backward().
        link: the link to whose parameters the values are added.
        parameters: names, as rayloc.gradient takes them; a group such as "tx" has several values.
        grid: the tones.
        max_depth: as of rayloc.trace.
        refraction: as of rayloc.trace.
        softness: as of rayloc.trace; above 0 the loss does not jump where a path appears.
        diffraction: as of rayloc.trace.
        diffuse_reflection: as of rayloc.trace; scattered echoes are no part of the channel.

    Returns:
        A complex tensor, the frequency response.

    Shapes: values (parameters,), the result (tones,).
    Units: metres, radians, S/m, or 1 of gains and eps_r.
    Frame: world, right-handed, z up.
    Errors: Error for a name that the scene has not and for a parameter without derivative; in
        backward() Error where the gradient of the loss is not finite, ValueError where a gain is -1;
        ModuleNotFoundError without torch.
    Source: engine/trace/path_derivatives.h, engine/trace/link_change.h.
    """
    options = {
        "max_depth": max_depth,
        "refraction": refraction,
        "softness": softness,
        "diffraction": diffraction,
        "diffuse_reflection": diffuse_reflection,
    }
    return Channel.apply(values, link, parameters, grid, options)
