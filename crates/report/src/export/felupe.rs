//! FElupe.

use super::{Exported, comments};

const BODY: &str = r#"
import sys

import felupe as fem
import numpy as np
import tensortrax.math as tm


def energy(C):
    """Strain energy (MPa) of the right Cauchy-Green tensor."""
    J2 = tm.linalg.det(C)
    Cb = J2 ** (-1 / 3) * C
    I1 = tm.trace(Cb)
    W = mu / 2 * (I1 - 3) + ((J2 - 1) / 2 - tm.log(J2) / 2) / D
    for sign in (1, -1):
        x, y = sign * np.sin(gamma), np.cos(gamma)
        I4 = x * x * Cb[0, 0] + 2 * x * y * Cb[0, 1] + y * y * Cb[1, 1]
        E = kappa * (I1 - 3) + (1 - 3 * kappa) * (I4 - 1)
        E = (E + tm.abs(E)) / 2  # fibres carry tension only
        W = W + k1 / (2 * k2) * (tm.exp(k2 * E ** 2) - 1)
    return W


def material():
    """The law as a material of FElupe."""
    return fem.Hyperelastic(energy)


def forces():
    """Force (N) at each stretch of FCT."""
    mesh = fem.Cube(n=2)
    region = fem.RegionHexahedron(mesh)
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    bounds = {
        "x": fem.Boundary(field[0], fx=0, skip=(0, 1, 1)),
        "y": fem.Boundary(field[0], fy=0, skip=(1, 0, 1)),
        "z": fem.Boundary(field[0], fz=0, skip=(1, 1, 0)),
        "move": fem.Boundary(field[0], fy=1, skip=(1, 0, 1)),
    }
    solid = fem.SolidBody(material(), field)
    out = []
    for stretch, _ in FCT:
        bounds["move"].value = stretch - 1
        dof0, dof1 = fem.dof.partition(field, bounds)
        ext0 = fem.dof.apply(field, bounds, dof0)
        done = fem.newtonraphson(items=[solid], dof0=dof0, dof1=dof1, ext0=ext0, tol=1e-10, verbose=0)
        out.append(fem.tools.force(field, done.fun, bounds["move"])[1])
    return np.array(out)


if __name__ == "__main__":
    theirs, ours = forces(), np.array([f for _, f in FCT])
    for (stretch, f), g in zip(FCT, theirs):
        print(f"stretch {stretch:.4f}: fct {f:.8e} N, FElupe {g:.8e} N")
    apart = np.abs(theirs - ours).max() / np.abs(ours).max()
    print(f"largest difference {apart:.2e} of the largest force")
    sys.exit(0 if apart < 1e-6 else 1)
"#;

/// The script: the law as a material, one cube, forces beside ours.
pub fn script(law: &Exported) -> String {
    let tried =
        "Run it: pip install felupe tensortrax; python THIS. It compares its forces with those of fct.";
    let head = comments("#", &law.head("FElupe", tried));
    let forces: String = law.forces.iter().map(|[s, f]| format!("    ({s:?}, {f:?}),\n")).collect();
    format!(
        "{head}\nmu, k1, k2 = {:?}, {:?}, {:?}  # MPa, MPa, -\ngamma, kappa = {:?}, {:?}  # rad to y, -\n\
         D = {:?}  # 1/MPa; the initial bulk modulus is 2/D\nFCT = [\n{forces}]\n{BODY}",
        law.mu, law.k1, law.k2, law.gamma, law.kappa, law.d
    )
}
