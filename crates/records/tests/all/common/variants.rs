//! The files of `tests/data`: what they are called, which dialect they are in, what must be said to read them.

use super::generic::{books, languages, looks, physics};
use super::{Look, decimal, encoded, pull};
use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};

/// A file and the flags it needs.
pub struct Variant {
    /// Name in `tests/data`.
    pub file: &'static str,
    /// Dialect that must be recognised.
    pub dialect: &'static str,
    /// Content.
    pub bytes: Vec<u8>,
    /// Flags and values.
    pub flags: &'static [(&'static str, &'static str)],
}

pub fn v(file: &'static str, dialect: &'static str, text: &str) -> Variant {
    Variant { file, dialect, bytes: text.as_bytes().to_vec(), flags: &[] }
}

impl Variant {
    pub fn bytes(self, bytes: Vec<u8>) -> Self {
        Self { bytes, ..self }
    }
    pub fn flags(self, flags: &'static [(&'static str, &'static str)]) -> Self {
        Self { flags, ..self }
    }
}

/// Every variant of the record.
pub fn all() -> Vec<Variant> {
    let parts = [
        canonical(),
        bluehill(),
        testxpert(),
        mts(),
        cellscale(),
        others(),
        languages(),
        physics(),
        looks(),
        books(),
    ];
    parts.into_iter().flatten().collect()
}

pub const P: Look = Look::PLAIN;
pub const C: Look = Look::COMMA;

fn canonical() -> Vec<Variant> {
    let text = format!("time_s,displacement_mm,force_N\n{}", P.table());
    vec![
        v("canonical.csv", "fct", &text),
        v("canonical-crlf.csv", "fct", &text.replace('\n', "\r\n")),
        v("canonical-cr.csv", "fct", &text.replace('\n', "\r")),
        v("canonical-bom.csv", "fct", &format!("\u{FEFF}# a comment, with a comma\n\n{text}")),
        v(
            "canonical-um-mN.csv",
            "fct",
            &format!("time_s,displacement_um,force_mN\n{}", Look { places: [3, 1, 1], ..P }.table()),
        ),
    ]
}

const BLUEHILL: &str = "Text Inputs : Specimen label,\"A 7\"\nGeneral : Start Date,13/11/2018 5:14 PM\n\
    Dimension : Width,6,mm\nDimension : Thickness,800,µm\nDimension : Length,10.0,mm\nNumber Inputs : Rate 1,3.00000,mm/min\n";

fn bluehill() -> Vec<Variant> {
    let head = |names: &str, units: &str| format!("{BLUEHILL}\n{names}\n{units}\n");
    let plain = format!("{}{}", head("Time,Extension,Load", "(sec),(mm),(N)"), P.table());
    let cyclic = P.rows(|i, [t, u, f]| vec![t, u, f, (22_476 + i / 16).to_string(), (i / 8).to_string()]);
    let twice = P.rows(|_, [t, u, f]| vec![t, u.clone(), f, u]);
    let german = format!("Allgemein : Startdatum;13.11.2018\n\nZeit;Weg;Kraft\n(s);(mm);(N)\n{}", C.table());
    let strain =
        P.rows(|i, [t, u, f]| vec![t, u.clone(), f, decimal(pull()[i][1], 5, '.', None), "0.1".into()]);
    let quoted = Look { quote: "\"", ..P };
    vec![
        v("bluehill.csv", "Bluehill", &plain),
        v("bluehill-crlf.csv", "Bluehill", &plain.replace('\n', "\r\n")),
        v(
            "bluehill-cyclic.csv",
            "Bluehill",
            &format!(
                "{}{cyclic}",
                head("Time,Extension,Load,Segment ID,Total Cycle Count", "(sec),(mm),(N),,")
            ),
        ),
        v(
            "bluehill-twice.csv",
            "Bluehill",
            &format!("{}{twice}", head("Time,Extension,Load,Tensile extension", "(sec),(mm),(N),(mm)")),
        ),
        v(
            "bluehill-kN.csv",
            "Bluehill",
            &format!(
                "{}{}",
                head("Time,Extension,Load", "(sec),(mm),(kN)"),
                Look { places: [3, 4, 7], ..P }.table()
            ),
        ),
        v(
            "bluehill-strain.csv",
            "Bluehill",
            &format!(
                "{}{strain}",
                head("Time,Extension,Load,Tensile strain,Tensile stress", "(sec),(mm),(N),(mm/mm),(MPa)")
            ),
        ),
        v(
            "bluehill-quoted.csv",
            "Bluehill",
            &format!(
                "{}{}",
                head("\"Time\",\"Extension\",\"Load\"", "\"(s)\",\"(mm)\",\"(N)\""),
                quoted.table()
            ),
        ),
        v(
            "bluehill-results.csv",
            "Bluehill",
            &format!(
                "Results Table 1,,,\n,Maximum Load,Tensile stress at Maximum Load,Extension at Break\n,(N),(MPa),(mm)\n1,0.5251,0.109,1.6\n\n{}",
                plain.replace(BLUEHILL, "")
            ),
        ),
        v("bluehill-german.csv", "Bluehill", &german).bytes(encoded(&german, WINDOWS_1252, false)),
        v("bluehill-utf16.csv", "Bluehill", "").bytes(encoded(&plain, UTF_16LE, true)),
    ]
}

fn testxpert() -> Vec<Variant> {
    let head = "Prüfprotokoll;testXpert II\nProbenbezeichnung;A 7\nProbendicke [mm];0,8\nProbenbreite;6,0;mm\nPrüfgeschwindigkeit: 3 mm/min\n\n";
    let units = format!("{head}Prüfzeit;Traversenweg;Standardkraft\ns;mm;N\n{}", C.table());
    let names = format!(
        "{head}Prüfzeit [s];Traversenweg [mm];Standardkraft [kN]\n{}",
        Look { places: [3, 4, 7], ..C }.table()
    );
    let english = format!(
        "Test time\tCrosshead position\tStandard force\ns\tmm\tN\n{}",
        Look { between: "\t", ..P }.table()
    );
    let deformation = C.rows(|i, [t, u, f]| vec![t, u, f, format!("{},5", i % 7)]);
    vec![
        v("testxpert.tra", "testXpert", "").bytes(encoded(&units, WINDOWS_1252, false)),
        v("testxpert-utf8.tra", "testXpert", &units),
        v("testxpert-kN.tra", "testXpert", "").bytes(encoded(&names, WINDOWS_1252, false)),
        v("testxpert-utf16.txt", "testXpert", "").bytes(encoded(&english, UTF_16LE, true)),
        v("testxpert-utf16be.txt", "testXpert", "").bytes(encoded(&english, UTF_16BE, false)),
        v(
            "testxpert-two-ways.csv",
            "testXpert",
            &format!("Prüfzeit;Standardweg;Standardkraft;Traversenweg\ns;mm;N;mm\n{deformation}"),
        )
        .flags(&[("displacement", "Standardweg")]),
        v("testxpert-tab.txt", "testXpert", &english),
    ]
}

fn mts() -> Vec<Variant> {
    let head = "MTS793|MPT|DEU|x|x|,|.|:|49|1|1|A\n\nBediener Information\t\t\t\t\t\tZeit:\t78,494141\ts\t22.07.2014 07:20:41\n\
        Datum : \t18.7.2000\nPrüfer : \tKh\nProbenbezeichnung :  \tA 7\nMasse :\t5646,2\nBediener Information Ende\n\n\
        Datenerfassung\t\t\t\t\t\tZeit:\t544,35547\ts\t22.07.2014 07:28:27\n";
    let line = |_: usize, [t, u, f]: [String; 3]| {
        vec!["41842".into(), t, "-1,5".into(), f, u, "-0,095031589".into()]
    };
    let look = Look { mark: ',', between: "\t", places: [3, 4, 7], ..P };
    let names = "Datum\tLaufzeit\tCh 1 Kraft Sollwert\tCh 1 Kraft\tCh 1 Weg\t1944 B\nd\ts\tkN\tkN\tmm\tmm\n";
    let german = format!("{head}{names}{}", look.rows(line));
    let rows: Vec<String> = Look { between: "\t", ..P }
        .rows(|_, [t, u, f]| vec![t, u, f])
        .lines()
        .map(|l| format!("{l}\n"))
        .collect();
    let block = |part: &[String], time: &str| {
        format!(
            "Data Acquisition\t\tTime:\t{time}\tSec\nRunning Time\tAxial Displacement\tAxial Load\nSec\tmm\tN\n{}\n",
            part.concat()
        )
    };
    let english = format!("MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\n{}", block(&rows, "10.0"));
    let blocks = format!(
        "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\n{}{}",
        block(&rows[..15], "7.0"),
        block(&rows[15..], "17.0")
    );
    vec![
        v("mts-deu.csv", "MTS 793", "").bytes(encoded(&german, WINDOWS_1252, false)),
        v("mts-deu-crlf.dat", "MTS 793", &german.replace('\n', "\r\n")),
        v("mts-enu.dat", "MTS 793", &english),
        v("mts-blocks.dat", "MTS 793", &blocks),
    ]
}

fn cellscale() -> Vec<Variant> {
    let look = Look { places: [3, 1, 1], ..P };
    let phase = |i: usize| {
        if i < 14 {
            "1-Stretch"
        } else if i < 22 {
            "1-Hold"
        } else {
            "1-Recover"
        }
    };
    let x = look.rows(|i, [t, u, f]| vec!["load".into(), phase(i).into(), t, "10000".into(), u, f]);
    let xy = look.rows(|i, [t, u, f]| {
        vec!["load".into(), phase(i).into(), t, "10000".into(), "6000".into(), u, "0".into(), f, "0.0".into()]
    });
    let single = P.rows(|i, [t, u, f]| vec!["load".into(), phase(i).into(), t, "10.0".into(), u, f]);
    let micro = Look { places: [0, 1, -2], ..P }.rows(|i, [t, u, f]| {
        vec![
            "noise".into(),
            phase(i).into(),
            t,
            f,
            format!("{}", i * i % 11),
            u,
            "64.6".into(),
            "36.9".into(),
        ]
    });
    let names = "Set Name,Cycle,Time(ms),Force(uN),Tip Displacement(um),Base Displacement(um),Current Size (um),Temperature (°C)";
    vec![
        v(
            "cellscale.csv",
            "CellScale",
            &format!("SetName,Cycle,Time_S,XSize_um,XDisplacement_um,XForce_mN\n{x}"),
        ),
        v(
            "cellscale-biaxial.csv",
            "CellScale",
            &format!(
                "SetName,Cycle,Time_S,XSize_um,YSize_um,XDisplacement_um,YDisplacement_um,XForce_mN,YForce_mN\n{xy}"
            ),
        ),
        v(
            "cellscale-ustretch.csv",
            "CellScale",
            &format!("SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N\n{single}"),
        ),
        v("microtester.csv", "MicroTester", &format!("{names}\n{micro}")),
        v("microtester-latin1.csv", "MicroTester", "").bytes(encoded(
            &format!("{names}\n{micro}"),
            WINDOWS_1252,
            false,
        )),
    ]
}

fn others() -> Vec<Variant> {
    let padded = |i: usize, [t, u, f]: [String; 3]| {
        vec![format!("{}", i + 1), format!(" {t}"), format!(" {u}"), format!("{f},")]
    };
    let wintest = format!(
        "\"WinTest 4.1 data\",\0\r\n\"Data acquisition : Scan 1\",\r\n\"Points\",\"Elapsed Time \",\"Disp\",\"Load 3\",\r\n\"\",\"Sec\",\"mm\",\"N\",\r\n{}",
        P.rows(padded).replace('\n', "\r\n")
    );
    let deben = "\"File : C:\\DATA\\NANO_K_1.MTR saved 2021-09-30 at 15:55:23\"\n\"Sample : A 7\"\n\"Span : 10,0\"\n\"Width : 6,0\"\n\
        \"Thickness : 0,8\"\n\"Start Sampletime : 100ms\"\n\"Start Speed : 0.1 mm/min\"\n\"Gain : x5\"\n\"\"\n\
        \"Max travel : 0,398mm\"\n\"Point\",\"Elongation\",\"Force\",\"Position\",\"Code\",\"Samplerate\",\"Motorspeed\"\n";
    let bare = |text: String| {
        let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
        let short = text.strip_prefix('0').filter(|t| t.starts_with('.')).map(str::to_owned).unwrap_or(text);
        if short.is_empty() { "0".into() } else { short }
    };
    let mtr = P.rows(|i, row| {
        let [t, u, f] = row.map(bare);
        vec![
            t,
            u,
            f,
            "0".into(),
            (if i == 0 { "2" } else { "0" }).into(),
            "100".into(),
            "\"0.1 mm/min\"".into(),
        ]
    });
    vec![
        v("wintest.csv", "WinTest", &wintest),
        v(
            "wintest-units-in-names.csv",
            "WinTest",
            &format!(
                "Points,Elapsed Time [Sec],Disp [mm],Load [N]\n{}",
                P.rows(|i, [t, u, f]| vec![(i + 1).to_string(), t, u, f])
            ),
        ),
        v("deben.mtr", "Deben", &format!("{deben}{mtr}")),
        v("deben-crlf.mtr", "Deben", &format!("{deben}{mtr}").replace('\n', "\r\n")),
    ]
}
