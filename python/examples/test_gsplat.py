"""A user's own test: gsplat's code for torch, judged. Needs pytest, torch and gsplat, and no GPU."""

import pytest

import conic
from conic.testing import assert_matches

torch = pytest.importorskip("torch")
gsplat = pytest.importorskip("gsplat.cuda._torch_impl")


def draw(scene, camera, least=1 / 255):
    """A picture by gsplat's projection and harmonics; all Gaussians are composited at every pixel."""
    means, quats, scales, opacities, sh = (torch.tensor(getattr(scene, name)) for name in (
        "means", "quats", "scales", "opacities", "sh"))
    view, K = (torch.tensor(matrix, dtype=torch.float32)[None] for matrix in (camera.viewmat, camera.K))
    covars, _ = gsplat._quat_scale_to_covar_preci(quats, scales, compute_preci=False)
    radii, means2d, depths, conics, _ = gsplat._fully_fused_projection(means, covars, view, K, camera.width,
                                                                       camera.height)
    directions = torch.nn.functional.normalize(means - torch.inverse(view)[0, :3, 3], dim=-1)
    colors = (gsplat._spherical_harmonics(scene.sh_degree, directions, sh) + 0.5).clamp(min=0)
    order = torch.argsort(depths[0])[(radii[0] > 0).reshape(len(means), -1).all(-1)[torch.argsort(depths[0])]]
    y, x = torch.meshgrid(torch.arange(camera.height) + 0.5, torch.arange(camera.width) + 0.5, indexing="ij")
    d = torch.stack([x, y], -1)[:, :, None] - means2d[0, order]
    a, b, c = conics[0, order].T
    power = 0.5 * (a * d[..., 0]**2 + c * d[..., 1]**2) + b * d[..., 0] * d[..., 1]
    alpha = (opacities[order] * torch.exp(-power)).clamp(max=0.999)
    alpha = torch.where((alpha < least) | (power < 0), torch.zeros(()), alpha)
    after = torch.cumprod(1 - alpha, -1)
    before = torch.cat([torch.ones_like(after[..., :1]), after[..., :-1]], -1)
    weights = torch.where(after > 1e-4, alpha * before, torch.zeros(()))
    return torch.einsum("hwn,nc->hwc", weights, colors[order])


@pytest.mark.parametrize("view", range(3))
def test_gsplat_is_right(view):
    scene = conic.make("gaussians", n=300, seed=view).gaussians()
    camera = conic.render(scene, size=(64, 48), azimuth=40 * view).camera
    assert_matches(scene, camera, draw(scene, camera), profile="gsplat-1.5")
    with pytest.raises(AssertionError):
        assert_matches(scene, camera, draw(scene, camera, least=0.05), profile="gsplat-1.5")
