//! Abaqus/Standard.

use super::{Exported, comments};
use std::fmt::Write;

/// The input file: `*Anisotropic Hyperelastic, Holzapfel` on one C3D8H.
pub fn deck(law: &Exported) -> String {
    let head =
        law.head("Abaqus/Standard", "NOT RUN THERE: keywords as documented, never tried in Abaqus by fct.");
    let mut out = comments("**", &head);
    let (sin, cos) = law.gamma.sin_cos();
    let move_by = law.last_stretch() - 1.0;
    // Writing to a String cannot fail.
    let _ = write!(
        out,
        "*Heading\n fct: one element\n*Node, nset=ALL\n\
         1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.\n\
         5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.\n\
         *Element, type=C3D8H, elset=CUBE\n1, 1, 2, 3, 4, 5, 6, 7, 8\n\
         *Nset, nset=X0\n1, 4, 5, 8\n*Nset, nset=Y0\n1, 2, 5, 6\n*Nset, nset=Z0\n1, 2, 3, 4\n*Nset, nset=TOP\n3, 4, 7, 8\n\
         *Orientation, name=FIBRES, local directions=2\n1., 0., 0., 0., 1., 0.\n3, 0.\n\
         {sin:?}, {cos:?}, 0.\n{:?}, {cos:?}, 0.\n\
         *Solid Section, elset=CUBE, material=TISSUE, orientation=FIBRES\n\
         *Material, name=TISSUE\n\
         ** C10 = mu/2, D, k1, k2, kappa\n\
         *Anisotropic Hyperelastic, holzapfel, local directions=2\n{:?}, {:?}, {:?}, {:?}, {:?}\n\
         *Boundary\nX0, 1, 1\nY0, 2, 2\nZ0, 3, 3\n\
         *Step, nlgeom=yes, inc=1000\n*Static\n0.1, 1., 1e-8, 0.1\n\
         *Boundary\nTOP, 2, 2, {move_by:?}\n\
         *Output, field\n*Node Output\nU, RF\n*Output, history\n*Node Output, nset=TOP\nU2, RF2\n*End Step\n",
        -sin,
        law.mu / 2.0,
        law.d,
        law.k1,
        law.k2,
        law.kappa
    );
    out
}
