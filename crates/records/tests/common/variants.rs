//! The files of `tests/data`: what they are called, which dialect they are in, what must be said to read them.

use super::office::{Cell, Sheet, ods, xls, xlsx};
use super::{Look, decimal, encoded, pull};
use encoding_rs::{GBK, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1252};

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

fn v(file: &'static str, dialect: &'static str, text: &str) -> Variant {
    Variant { file, dialect, bytes: text.as_bytes().to_vec(), flags: &[] }
}

impl Variant {
    fn bytes(self, bytes: Vec<u8>) -> Self {
        Self { bytes, ..self }
    }
    fn flags(self, flags: &'static [(&'static str, &'static str)]) -> Self {
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

const P: Look = Look::PLAIN;
const C: Look = Look::COMMA;

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

fn languages() -> Vec<Variant> {
    let table = |names: &str| format!("{names}\n{}", C.table());
    let german = table("Zeit in s;Längenänderung in mm;Kraft in N");
    let french = table("Temps (s);Déplacement (mm);Force (N)");
    let polish = table("Czas [s];Wydłużenie [mm];Siła [N]");
    let chinese = format!("时间(s),位移(mm),力(N)\n{}", P.table());
    let units = format!("时间,位移,负荷\n秒,毫米,牛\n{}", P.table());
    let list = [
        ("german.csv", "german-latin1.csv", german, WINDOWS_1252),
        ("french.csv", "french-latin1.csv", french, WINDOWS_1252),
        ("polish.csv", "polish-cp1250.csv", polish, WINDOWS_1250),
        ("chinese.csv", "chinese-gbk.csv", chinese, GBK),
        ("chinese-units.csv", "chinese-units-gbk.csv", units, GBK),
    ];
    let both = list.into_iter().flat_map(|(utf8, old, text, page)| {
        [
            v(utf8, "generic", "").bytes(encoded(&text, UTF_8, utf8.starts_with('g'))),
            v(old, "generic", "").bytes(encoded(&text, page, false)),
        ]
    });
    let said = encoded(&table("Zeit [s];Weg [mm];Kraft [N]"), UTF_16BE, true);
    both.chain([
        v("spanish.csv", "generic", &table("Tiempo [s];Desplazamiento [mm];Fuerza [N]")),
        v("italian.csv", "generic", &table("Tempo [s];Spostamento [mm];Forza [N]")),
        v("russian.csv", "generic", &table("Время, s;Перемещение, mm;Сила, N")),
        v("german-utf16be.csv", "generic", "").bytes(said),
    ])
    .collect()
}

fn physics() -> Vec<Variant> {
    let with =
        |names: &str, line: fn(usize, [String; 3]) -> Vec<String>| format!("{names}\n{}", P.rows(line));
    let u = |i: usize| pull()[i][1];
    vec![
        // 0.1 µm of 10 mm are 1e-5.
        v(
            "stretch.csv",
            "generic",
            &with("Time [s],Stretch,Force [N]", |i, [t, _, f]| {
                vec![t, decimal(100_000 + pull()[i][1], 5, '.', None), f]
            }),
        )
        .flags(&[("geometry", "")]),
        v(
            "strain-percent.csv",
            "generic",
            &with("Time [s],Strain [%],Force [N]", |i, [t, _, f]| {
                vec![t, decimal(pull()[i][1], 3, '.', None), f]
            }),
        )
        .flags(&[("geometry", "")]),
        v(
            "strain-no-unit.csv",
            "generic",
            &with("Time [s],Strain,Force [N]", |i, [t, _, f]| {
                vec![t, decimal(pull()[i][1], 5, '.', None), f]
            }),
        )
        .flags(&[("geometry", ""), ("units", "displacement=1")]),
        v("no-time.csv", "generic", &with("Extension [mm],Load [N]", |_, [_, u, f]| vec![u, f]))
            .flags(&[("frequency", "2")]),
        v("no-header.csv", "generic", &P.table()).flags(&[
            ("time", "1"),
            ("displacement", "2"),
            ("force", "3"),
            ("units", "time=s,displacement=mm,force=N"),
        ]),
        v("no-units.csv", "generic", &format!("Time,Extension,Load\n{}", P.table()))
            .flags(&[("units", "time=s,displacement=mm,force=N")]),
        v(
            "two-forces.csv",
            "generic",
            &with("Time [s],Extension [mm],Load [N],Load [kN]", |i, [t, u, f]| {
                vec![t, u, f, format!("{}", i * 3 % 5)]
            }),
        )
        .flags(&[("force", "Load [N]")]),
        v("negative.csv", "generic", &P.rows(|_, [t, u, f]| vec![t, format!("-{u}"), format!("-{f}")]))
            .bytes(
                format!(
                    "t [s],u [mm],F [N]\n{}",
                    P.rows(|_, [t, u, f]| vec![t, format!("-{u}"), format!("-{f}")])
                )
                .into_bytes(),
            )
            .flags(&[("displacement", "u [mm]"), ("flip", "")]),
        v(
            "offset.csv",
            "generic",
            &with("Time [s],Extension [mm],Load [N]", |_, [t, u, f]| vec![t, u, f])
                .replace("Extension [mm]", "Position [mm]"),
        )
        .flags(&[("zero", "")]),
        v(
            "command.csv",
            "generic",
            &with("Time [s],Displacement command [mm],Displacement [mm],Force [N]", |i, [t, u, f]| {
                vec![t, format!("{i}"), u, f]
            }),
        ),
        v(
            "camera.csv",
            "generic",
            &with("Time [s],Extension [mm],Load [N],Tear front [mm],Width change [um]", |i, [t, u, f]| {
                let seen = i % 3 == 0;
                let front = if seen { format!("1.{i}") } else { String::new() };
                vec![t, u, f, front, format!("-{i}")]
            }),
        ),
        v(
            "steps.csv",
            "generic",
            &format!(
                "Cycle;Time [s];Extension [mm];Load [N]\n{}",
                Look { between: ";", ..P }.rows(|i, [t, u, f]| { vec![format!("{}", 1 + i / 10), t, u, f] })
            ),
        ),
        v(
            "minutes.csv",
            "generic",
            &format!(
                "# strip 7\n# Time (ms)  Stroke (um)  Load (cN)\n{}",
                Look { places: [0, 1, 2], between: " ", ..P }.rows(|i, [t, v, f]| {
                    let _ = u(i);
                    vec![t, v, f]
                })
            ),
        ),
    ]
}

fn looks() -> Vec<Variant> {
    let head = |names: [&str; 3], look: &Look| format!("{}\n{}", names.join(look.between), look.table());
    let mm = ["Time [s]", "Extension [mm]", "Load [N]"];
    let small = ["Time [ms]", "Extension [µm]", "Load [µN]"];
    let grouped =
        |mark, group, between| Look { places: [0, 1, -2], mark, group: Some(group), between, quote: "" };
    let exponent = |x: i64, places: i32| format!("{}E-0{places}", decimal(x, 0, '.', None));
    let e: String = pull()
        .iter()
        .map(|[t, u, f]| format!("{},{},{}\n", exponent(*t, 3), exponent(*u, 4), exponent(*f, 4)))
        .collect();
    vec![
        v("semicolon.csv", "generic", &head(mm, &C)),
        v("tab.txt", "generic", &head(mm, &Look { between: "\t", ..P })),
        v("tab-comma.txt", "generic", &head(mm, &Look { between: "\t", mark: ',', ..P })),
        v("bar.txt", "generic", &head(mm, &Look { between: "|", ..P })),
        v(
            "blanks.txt",
            "generic",
            &format!("Time[s] Extension[mm] Load[N]\n{}", Look { between: "   ", ..P }.table()),
        ),
        v(
            "blanks-comma.txt",
            "generic",
            &format!(
                "  Time (s)   Extension (mm)   Load (N)\n{}",
                Look { between: "  ", mark: ',', ..P }.table()
            ),
        ),
        v("quoted-comma.csv", "generic", &head(mm, &Look { mark: ',', quote: "\"", ..P })),
        v("thousands-point.csv", "generic", &head(small, &grouped(',', '.', ";"))),
        v("thousands-comma.csv", "generic", &head(small, &Look { quote: "\"", ..grouped('.', ',', ",") })),
        v("thousands-blank.csv", "generic", &head(small, &grouped(',', ' ', ";"))),
        v("thousands-nbsp.csv", "generic", &head(small, &grouped(',', '\u{A0}', ";"))),
        v("thousands-apostrophe.csv", "generic", &head(small, &grouped('.', '\'', ";"))),
        v(
            "exponents.csv",
            "generic",
            &format!("t (s),Displacement / mm,F, N\n{e}").replace("F, N", "F in N"),
        ),
        v(
            "trailing.csv",
            "generic",
            &format!(
                "Time [s],Extension [mm],Load [N],\n{}",
                P.rows(|_, [t, u, f]| vec![t, u, f, String::new()])
            ),
        ),
        v("old-mac.csv", "generic", &head(mm, &C).replace('\n', "\r")),
        v("skip.txt", "generic", &format!("1;2;3\n4;5;6\n7;8;9\n{}", head(mm, &C)))
            .flags(&[("skip-rows", "3")]),
    ]
}

fn books() -> Vec<Variant> {
    let text = |t: &str| Cell::Text(t.into());
    let rows = |places: [i32; 3]| -> Sheet {
        let cells =
            |r: &[i64; 3]| (0..3).map(|k| Cell::Number(decimal(r[k], places[k], '.', None))).collect();
        pull().iter().map(cells).collect()
    };
    let mut sheet: Sheet = vec![
        vec![text("Specimen"), text("A 7")],
        vec![text("Width"), Cell::Number("6".into()), text("mm")],
        vec![],
        vec![text("Time"), text("Extension"), text("Load")],
        vec![text("s"), text("mm"), text("N")],
    ];
    sheet.extend(rows([3, 4, 4]));
    let mut names: Sheet =
        vec![vec![text("Prüfzeit [s]"), text("Traversenweg [mm]"), text("Standardkraft [kN]")]];
    names.extend(rows([3, 4, 7]));
    let mut written: Sheet = vec![vec![text("Zeit [s]"), text("Weg [mm]"), text("Kraft [N]")]];
    written.extend(pull().iter().map(|r| C.cells(r).iter().map(|c| text(c)).collect::<Vec<_>>()));
    let results: Sheet = vec![vec![text("Max. force"), Cell::Number("0.5251".into()), Cell::Empty]];
    vec![
        v("book.xlsx", "generic", "").bytes(xlsx(&[("Results", results.clone()), ("Raw", sheet.clone())])),
        v("book-testxpert.xlsx", "testXpert", "").bytes(xlsx(&[("Werte", names.clone())])),
        v("book-two.xlsx", "generic", "")
            .bytes(xlsx(&[("Specimen 1", sheet.clone()), ("Specimen 2", sheet.clone())]))
            .flags(&[("sheet", "Specimen 2")]),
        v("book-texts.xlsx", "generic", "").bytes(xlsx(&[("Tabelle1", written)])),
        v("book.ods", "generic", "").bytes(ods(&[("Results", results), ("Raw", sheet.clone())])),
        v("book.xls", "generic", "").bytes(xls("Raw", &sheet)),
    ]
}
