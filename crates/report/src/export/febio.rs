//! FEBio 4.

use super::{Exported, comments};

/// The input file: `Holzapfel-Gasser-Ogden` on one hexahedron.
pub fn deck(law: &Exported) -> String {
    let tried = "NOT RUN THERE: keywords as documented, never tried in FEBio by fct. FEBio's volumetric energy may be of \
                 another form: initial bulk moduli agree.";
    let head = comments("    ", &law.head("FEBio 4", tried));
    let nodes = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let nodes: String = nodes
        .iter()
        .enumerate()
        .map(|(i, [x, y, z])| format!("      <node id=\"{}\">{x},{y},{z}</node>\n", i + 1))
        .collect();
    let set = |name: &str, ids: &str| format!("    <NodeSet name=\"{name}\">{ids}</NodeSet>\n");
    let sets = set("X0", "1,4,5,8") + &set("Y0", "1,2,5,6") + &set("Z0", "1,2,3,4") + &set("TOP", "3,4,7,8");
    let fixed = |name: &str, axis: char| {
        format!(
            "    <bc type=\"zero displacement\" node_set=\"{name}\"><x_dof>{}</x_dof><y_dof>{}</y_dof><z_dof>{}</z_dof></bc>\n",
            u8::from(axis == 'x'),
            u8::from(axis == 'y'),
            u8::from(axis == 'z')
        )
    };
    let held = fixed("X0", 'x') + &fixed("Y0", 'y') + &fixed("Z0", 'z');
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n{head}-->\n<febio_spec version=\"4.0\">\n  <Module type=\"solid\"/>\n  \
         <Control>\n    <analysis>STATIC</analysis>\n    <time_steps>10</time_steps>\n    <step_size>0.1</step_size>\n  </Control>\n  \
         <Material>\n    <material id=\"1\" name=\"tissue\" type=\"Holzapfel-Gasser-Ogden\">\n      \
         <c>{:?}</c>\n      <k1>{:?}</k1>\n      <k2>{:?}</k2>\n      <gamma>{:?}</gamma>\n      <kappa>{:?}</kappa>\n      <k>{:?}</k>\n      \
         <mat_axis type=\"vector\"><a>0,1,0</a><d>1,0,0</d></mat_axis>\n    </material>\n  </Material>\n  \
         <Mesh>\n    <Nodes name=\"cube\">\n{nodes}    </Nodes>\n    \
         <Elements type=\"hex8\" name=\"part\"><elem id=\"1\">1,2,3,4,5,6,7,8</elem></Elements>\n{sets}  </Mesh>\n  \
         <MeshDomains>\n    <SolidDomain name=\"part\" mat=\"tissue\"/>\n  </MeshDomains>\n  \
         <Boundary>\n{held}    <bc type=\"prescribed displacement\" node_set=\"TOP\"><dof>y</dof><value lc=\"1\">{:?}</value>\
         <relative>0</relative></bc>\n  </Boundary>\n  \
         <LoadData>\n    <load_controller id=\"1\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,1</pt></points></load_controller>\n  \
         </LoadData>\n  \
         <Output>\n    <logfile><node_data data=\"y;Ry\" name=\"top\" node_set=\"TOP\"/></logfile>\n  </Output>\n</febio_spec>\n",
        law.mu,
        law.k1,
        law.k2,
        law.gamma.to_degrees(),
        law.kappa,
        2.0 / law.d,
        law.last_stretch() - 1.0
    )
}
