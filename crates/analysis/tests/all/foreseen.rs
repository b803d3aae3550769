//! What a design says of protocols.

// Records are of its own.
#[allow(dead_code)]
use crate::small;

use analysis::{DesignRequest, RatedProtocol, design};
use input::Case;
use std::path::Path;
use std::sync::Arc;

const MODEL: &str = r#"
[mesh]
divisions = [4, 6, 1]
[bulk]
mu_kPa = 20.0
k1_kPa = 400.0
k2 = 2.0
gamma_deg = 40.0
kappa = 0.2
[interface]
gc_N_per_mm = 0.05
sigma_c_MPa = 0.1
"#;

fn strip(folder: &Path) -> Case {
    let text = small::STRIP
        .replace("data = \"uniaxial.csv\"", "protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }]")
        .replace("data = \"tearing.csv\"", "protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]");
    let file = folder.join("case.toml");
    std::fs::write(&file, format!("{text}{MODEL}")).expect("written");
    input::read_case(&file, &effects::catalogue()).expect("a good file")
}

#[test]
fn a_design_prefers_protocols_that_show_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = Arc::new(strip(folder.path()));
    let rivals = Some(["viscoelastic", "mullins"].map(str::to_owned));
    let request = DesignRequest { budget_s: 3600.0, rivals, range_n: Some(1e-3), ..DesignRequest::default() };
    let answer = design(&case, &effects::catalogue(), &request, &|_| {}, &|| false).expect("a design");
    let of = |name: &str| answer.protocols.iter().find(|p| p.name == name).expect("weighed");
    let snr = |w: &RatedProtocol, effect: &str| {
        w.force.effects.iter().find(|e| e.effect == effect).map_or(0.0, |e| e.snr)
    };
    for (protocol, effect) in [("loops", "mullins"), ("loops", "permanent_set"), ("holds", "viscoelastic")] {
        let (with, without) = (snr(of(protocol), effect), snr(of("pull"), effect));
        assert!(with > 1.5 * without, "{effect}: {with} with {protocol}, {without} without");
    }
    assert_ne!(answer.protocols[0].name, "pull");
    let gc = |w: &RatedProtocol| {
        w.force.parameters.iter().find(|k| k.path.ends_with("gc")).expect("gc").relative_error
    };
    assert!(gc(&answer.protocols[0]) > 0.0 && gc(&answer.protocols[0]) < 0.5);
    // A camera takes nothing away.
    for w in &answer.protocols {
        let seen = |f: &analysis::Foresight| f.effects.iter().filter(|e| e.power >= 0.9).count();
        assert!(seen(&w.camera) >= seen(&w.force), "{}", w.name);
        let [force, camera] = w.rivals_power.expect("rivals");
        assert!(camera >= force - 1e-9, "{}: {force} {camera}", w.name);
    }
    assert!(answer.variants.iter().any(|v| v.power > 0.5), "{:?}", answer.variants);
    assert!(answer.remarks.iter().any(|r| r.contains("the load cell ends at")), "{:?}", answer.remarks);
    let hurried = DesignRequest { budget_s: 0.5, ..DesignRequest::default() };
    assert!(design(&case, &effects::catalogue(), &hurried, &|_| {}, &|| false).is_err());
}
