"""The channel as a function of torch; skipped where torch is not installed."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import rayloc


def test_without_torch_its_package_is_named() -> None:
    program = "import sys; sys.modules['torch'] = None; import rayloc.autograd"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode != 0
    assert "python3-torch" in done.stderr.splitlines()[-1], done.stderr


def test_gradients_of_torch_are_those_of_the_engine(room: rayloc.Scene) -> None:
    torch = pytest.importorskip("torch", reason="torch is not installed (Debian's python3-torch)")
    import rayloc.autograd

    grid = rayloc.OfdmGrid.of(5.19e9, count=16)
    link = rayloc.Link(room, rayloc.Transmitter((0.4, 1, 1.5)), rayloc.Receiver((-1.4, 1.05, 1.2)))
    names = ["tx.0", "tx.1", "eps_r.wood", "tx_gain"]
    values = torch.tensor([0.01, -0.02, 0.1, 0.3], dtype=torch.float64, requires_grad=True)
    h = rayloc.autograd.channel(values, link, names, grid)
    h.abs().square().sum().backward()
    moved = rayloc.changed(link, names, values.detach().numpy())
    paths = rayloc.trace(*moved[:3])
    _, wanted = rayloc.gradient(paths, grid, 2 * moved.gain * rayloc.cfr(paths, grid), names)
    assert np.allclose(values.grad.numpy()[:3], moved.gain * wanted[:3], rtol=1e-12)
    assert np.allclose(values.grad.numpy()[3], wanted[3], rtol=1e-12)
    small = lambda at: rayloc.autograd.channel(at, link, names, grid)  # noqa: E731
    assert torch.autograd.gradcheck(small, (values,), eps=1e-6, atol=1e-6)


def test_a_group_of_parameters_has_the_gradient_of_its_members(room: rayloc.Scene) -> None:
    torch = pytest.importorskip("torch", reason="torch is not installed (Debian's python3-torch)")
    import rayloc.autograd

    grid = rayloc.OfdmGrid.of(5.19e9, count=16)
    link = rayloc.Link(room, rayloc.Transmitter((0.4, 1, 1.5)), rayloc.Receiver((-1.4, 1.05, 1.2)))

    def gradient(names: list[str], gain: float) -> Any:
        values = torch.tensor([0.01, -0.02, 0.0, gain], dtype=torch.float64, requires_grad=True)
        h = rayloc.autograd.channel(values, link, names, grid)
        (h.conj() * (1 + 2j)).real.sum().backward()  # torch hands on a conjugate view
        return values.grad.numpy()

    members = ["tx.0", "tx.1", "tx.2", "tx_gain"]
    assert np.allclose(gradient(["tx", "tx_gain"], 0.3), gradient(members, 0.3), rtol=1e-12)
    with pytest.raises(ValueError, match="tx_gain of -1"):
        gradient(["tx", "tx_gain"], -1.0)
