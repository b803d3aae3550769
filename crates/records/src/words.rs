//! One table of what columns and dimensions are called, in the languages of the labs.

use crate::units::Measure;
use serde::Serialize;

/// What a column is for a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Time.
    Time,
    /// Displacement of the actuator.
    Displacement,
    /// Force of the load cell.
    Force,
    /// Engineering or true strain, instead of the displacement.
    Strain,
    /// Stretch, instead of the displacement.
    Stretch,
    /// Nominal or true stress, instead of the force.
    Stress,
    /// Camera: change of the distance between the clamped edges.
    GripDisplacement,
    /// Camera: position of the tear's front.
    TearFront,
    /// Camera: change of the width.
    WidthChange,
    /// Displacement of the actuator that pulls along x, in a biaxial test.
    DisplacementX,
    /// Force of the load cell along x, in a biaxial test.
    ForceX,
    /// Name or number of a segment, cycle or phase.
    Segment,
}

impl Role {
    /// The flag that names its column.
    pub fn flag(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement | Self::Strain | Self::Stretch => "displacement",
            Self::Force | Self::Stress => "force",
            Self::GripDisplacement => "grip-displacement",
            Self::TearFront => "tear-front",
            Self::WidthChange => "width-change",
            Self::DisplacementX => "displacement-x",
            Self::ForceX => "force-x",
            Self::Segment => "segment",
        }
    }

    /// What may stand for a channel, best first.
    pub(crate) fn stand_ins(self) -> &'static [Role] {
        match self {
            Self::Displacement => &[Self::Displacement, Self::Stretch, Self::Strain],
            Self::Force => &[Self::Force, Self::Stress],
            Self::Time => &[Self::Time],
            Self::GripDisplacement => &[Self::GripDisplacement],
            Self::TearFront => &[Self::TearFront],
            Self::WidthChange => &[Self::WidthChange],
            Self::DisplacementX => &[Self::DisplacementX],
            Self::ForceX => &[Self::ForceX],
            _ => &[],
        }
    }

    /// The channel in a sentence.
    pub fn spoken(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement => "displacement",
            Self::Force => "force",
            Self::Strain => "strain",
            Self::Stretch => "stretch",
            Self::Stress => "stress",
            Self::GripDisplacement => "clamps' displacement",
            Self::TearFront => "tear's front",
            Self::WidthChange => "change of width",
            Self::DisplacementX => "displacement along x",
            Self::ForceX => "force along x",
            Self::Segment => "segment",
        }
    }

    /// What its unit measures; `None` for text.
    pub fn measure(self) -> Option<Measure> {
        match self {
            Self::Time => Some(Measure::Time),
            Self::Displacement
            | Self::GripDisplacement
            | Self::TearFront
            | Self::WidthChange
            | Self::DisplacementX => Some(Measure::Length),
            Self::Force | Self::ForceX => Some(Measure::Force),
            Self::Strain | Self::Stretch => Some(Measure::Ratio),
            Self::Stress => Some(Measure::Stress),
            Self::Segment => None,
        }
    }
}

/// Names of columns, folded as by [`fold`], a bar between them. The first language that fits is as good as any.
const COLUMNS: &[(Role, &str)] = &[
    (
        Role::Time,
        "time|test time|elapsed time|running time|time elapsed|t|timestamp|time stamp|zeit|prufzeit|\
         laufzeit|testzeit|messzeit|temps|temps ecoule|duree|czas|czas probny|czas badania|tiempo|\
         tempo|tid|cas|время|时间|時間|试验时间",
    ),
    (
        Role::Displacement,
        "displacement|extension|elongation|disp|crosshead|crosshead displacement|crosshead position|\
         crosshead travel|crosshead extension|actuator displacement|actuator position|stroke|\
         position|travel|grip separation|axial displacement|tensile extension|tensile displacement|\
         base displacement|weg|standardweg|traversenweg|traverse|kolbenweg|maschine|maschinenweg|\
         verschiebung|verlangerung|langenanderung|verformung|deplacement|allongement|course|\
         traverse deplacement|przemieszczenie|wydluzenie|droga|desplazamiento|alargamiento|\
         spostamento|allungamento|перемещение|удлинение|位移|伸长|伸长量|横梁位移|变形|變位",
    ),
    (
        Role::Force,
        "force|load|standard force|test force|tensile force|axial force|axial load|load cell|f|\
         kraft|standardkraft|prufkraft|zugkraft|last|charge|effort|force standard|sila|obciazenie|\
         fuerza|carga|forza|carico|kracht|kraftaufnehmer|сила|нагрузка|力|负荷|載荷|载荷|试验力|力值|荷重",
    ),
    (
        Role::Strain,
        "strain|tensile strain|engineering strain|nominal strain|axial strain|true strain|\
         logarithmic strain|hencky strain|dehnung|wahre dehnung|deformation|odksztalcenie|\
         deformacion|deformazione|деформация|应变",
    ),
    (Role::Stretch, "stretch|stretch ratio|lambda|λ|streckung|elongation ratio|伸长比"),
    (
        Role::Stress,
        "stress|tensile stress|engineering stress|nominal stress|true stress|cauchy stress|\
         axial stress|first piola kirchhoff stress|pk1|spannung|zugspannung|wahre spannung|\
         contrainte|naprezenie|tension|esfuerzo|tensione|напряжение|应力",
    ),
    (
        Role::GripDisplacement,
        "grip displacement|camera displacement|optical displacement|clamp displacement|\
         video extension",
    ),
    (Role::TearFront, "tear front|crack length|crack tip|crack front|tear length|risslange"),
    (Role::WidthChange, "width change|change of width|transverse displacement|breitenanderung"),
    (
        Role::Segment,
        "segment|segment id|cycle|cycle count|total cycle count|total cycles|phase|step|step number|\
         zyklus|zyklen|schritt|abschnitt|cykl|cyklus|ciclo|set name|setname|set|scan|循环|阶段",
    ),
];

/// Words that make a column something else: what was wanted, not measured; a rate; an extreme.
const NOT: &[&str] = &[
    "sollwert",
    "soll",
    "command",
    "setpoint",
    "target",
    "demand",
    "commanded",
    "feedback error",
    "error",
    "rate",
    "speed",
    "velocity",
    "geschwindigkeit",
    "max",
    "min",
    "peak",
    "maximum",
    "minimum",
    "at",
    "bei",
    "start",
    "date",
    "datum",
    "temperature",
    "temperatur",
    "consigne",
    "zadana",
    "test id",
    "samplerate",
    "motorspeed",
    "corrected",
];

/// Words before or after a name that say which channel it is, not what.
const CHANNEL: &[&str] =
    &["ch", "channel", "kanal", "canal", "axial", "x", "y", "the", "1", "2", "3", "4", "fb", "tip"];

/// Letters without marks, lower case, one blank between words, camel case parted.
pub fn fold(name: &str) -> String {
    let mut out = String::new();
    let mut before = ' ';
    for c in name.chars() {
        if c.is_uppercase() && before.is_lowercase() {
            out.push(' ');
        }
        before = c;
        for c in c.to_lowercase() {
            match c {
                'ä' | 'à' | 'â' | 'á' | 'ã' | 'ą' => out.push('a'),
                'ö' | 'ò' | 'ô' | 'ó' | 'õ' | 'ø' => out.push('o'),
                'ü' | 'ù' | 'û' | 'ú' | 'ů' => out.push('u'),
                'é' | 'è' | 'ê' | 'ë' | 'ę' | 'ě' => out.push('e'),
                'í' | 'ì' | 'î' | 'ï' => out.push('i'),
                'ç' | 'ć' | 'č' => out.push('c'),
                'ł' => out.push('l'),
                'ń' | 'ñ' => out.push('n'),
                'ś' | 'š' => out.push('s'),
                'ź' | 'ż' | 'ž' => out.push('z'),
                'ß' => out.push_str("ss"),
                c if c.is_alphanumeric() => out.push(c),
                _ => out.push(' '),
            }
        }
    }
    // `XForce` is the force along x.
    let parted = |w: &str| match w.strip_prefix(['x', 'y']) {
        Some(rest @ ("force" | "displacement" | "size" | "load" | "position")) => {
            format!("{} {rest}", &w[..1])
        }
        _ => w.to_owned(),
    };
    out.split_whitespace().map(parted).collect::<Vec<_>>().join(" ")
}

/// How well a column's name (without unit) says that it plays a role: 3 it is the name, 2 but for a channel, 1 the
/// name is in it, 0 not.
pub fn fits(name: &str, role: Role) -> u8 {
    let folded = fold(name);
    let words: Vec<&str> = folded.split(' ').collect();
    let listed = || COLUMNS.iter().filter(move |(r, _)| *r == role).flat_map(|(_, n)| n.split('|'));
    let segment = role == Role::Segment;
    if listed().any(|n| n == folded) {
        return 3;
    }
    if !segment && words.iter().any(|w| NOT.contains(w)) {
        return 0;
    }
    let bare = words.iter().filter(|w| !CHANNEL.contains(w)).copied().collect::<Vec<_>>().join(" ");
    if listed().any(|n| n == bare) {
        return 2;
    }
    // Letters alone (t, F) mean something only by themselves; other scripts have no blanks between words.
    let inside = |n: &str| {
        if n.is_ascii() {
            n.len() > 2 && format!(" {folded} ").contains(&format!(" {n} "))
        } else {
            folded.contains(n)
        }
    };
    u8::from(!segment && listed().any(inside))
}

/// Whether a text is the name of a column, or the key of a dimension, in any language.
pub(crate) fn is_known(text: &str) -> bool {
    let (bare, _) = crate::units::split(text);
    COLUMNS.iter().any(|(role, _)| fits(&bare, *role) > 1) || dimension(&bare).is_some()
}

/// What a header may say of the specimen and the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Dimension {
    /// Length between the clamps.
    Length,
    /// Width.
    Width,
    /// Thickness.
    Thickness,
    /// Cut from the edge.
    Cut,
    /// Speed of the actuator.
    Rate,
    /// Name of the specimen.
    Name,
    /// What somebody noted.
    Note,
}

/// Keys of header lines, folded, a bar between them.
const DIMENSIONS: &[(Dimension, &str)] = &[
    (
        Dimension::Length,
        "gauge length|gage length|initial length|grip separation|grip to grip separation|length|\
         specimen length|span|l0|lo|anfangslange|messlange|einspannlange|probenlange|lange|longueur|\
         longueur initiale|entre mors|dlugosc|dlugosc pomiarowa|longitud|lunghezza|标距|原始标距|试样长度",
    ),
    (
        Dimension::Width,
        "width|specimen width|breite|probenbreite|b0|largeur|szerokosc|ancho|larghezza|宽度|试样宽度",
    ),
    (
        Dimension::Thickness,
        "thickness|specimen thickness|dicke|probendicke|a0|epaisseur|grubosc|espesor|spessore|厚度|\
         试样厚度",
    ),
    (Dimension::Cut, "cut|initial cut|notch|notch length|pre cut|kerbe|anfangsriss|initial crack"),
    (
        Dimension::Rate,
        "rate|test speed|speed|start speed|crosshead speed|extension rate|strain rate 1|\
         prufgeschwindigkeit|geschwindigkeit|vitesse|predkosc|velocidad|试验速度|rate 1|ramp rate",
    ),
    (
        Dimension::Name,
        "specimen|specimen label|specimen name|sample|sample name|probe|probenbezeichnung|\
         probenname|eprouvette|probka|nazwa probki|试样编号|specimen id",
    ),
    (
        Dimension::Note,
        "note|notes|comment|comments|remark|remarks|bemerkung|bemerkungen|commentaire|uwagi|komentarz|provenance|备注",
    ),
];

/// What a header line's key (without unit) is about. What stands before a last colon (`Dimension : Width`) is a group.
pub fn dimension(key: &str) -> Option<Dimension> {
    let of = |text: &str| {
        let folded = fold(text);
        DIMENSIONS.iter().find(|(_, names)| names.split('|').any(|n| n == folded)).map(|d| d.0)
    };
    let key = key.trim().trim_end_matches(':').trim();
    of(key).or_else(|| of(key.rsplit(':').next().unwrap_or(key)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_labs_are_known() {
        for (name, role) in [
            ("Time", Role::Time),
            ("Prüfzeit", Role::Time),
            ("Temps", Role::Time),
            ("Czas", Role::Time),
            ("时间", Role::Time),
            ("Elapsed Time", Role::Time),
            ("Extension", Role::Displacement),
            ("Längenänderung", Role::Displacement),
            ("Wydłużenie", Role::Displacement),
            ("Déplacement", Role::Displacement),
            ("位移", Role::Displacement),
            ("Base Displacement", Role::Displacement),
            ("XForce", Role::Force),
            ("Ch 1 Kraft", Role::Force),
            ("Siła", Role::Force),
            ("负荷", Role::Force),
            ("Tensile stress", Role::Stress),
            ("Stretch", Role::Stretch),
            ("Dehnung", Role::Strain),
            ("SetName", Role::Segment),
            ("Total Cycle Count", Role::Segment),
        ] {
            assert!(fits(name, role) >= 2, "{name}");
        }
        assert_eq!(fits("Ch 1 Kraft Sollwert", Role::Force), 0);
        assert_eq!(fits("Motorspeed", Role::Displacement), 0);
        assert_eq!(fits("Peak Load", Role::Force), 0);
        assert_eq!(fits("Tip Displacement", Role::Displacement), 2);
        assert_eq!(fits("Load Channel", Role::Force), 2);
    }

    #[test]
    fn every_name_is_written_as_it_is_folded() {
        let names = COLUMNS.iter().map(|c| c.1).chain(DIMENSIONS.iter().map(|d| d.1));
        let names = names.flat_map(|n| n.split('|'));
        for name in names {
            assert_eq!(fold(name), name);
        }
        assert_eq!(dimension("Dimension : Width"), Some(Dimension::Width));
        assert_eq!(dimension("Probendicke"), Some(Dimension::Thickness));
        assert_eq!(dimension("Video file"), None);
    }
}
