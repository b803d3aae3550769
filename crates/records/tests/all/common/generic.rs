//! Files of no program in particular: languages, strains and stresses, looks, workbooks.

use super::office::{Cell, Sheet, ods, xls, xlsx};
use super::variants::{C, P, Variant, v};
use super::{Look, decimal, encoded, pull};
use encoding_rs::{GBK, UTF_8, UTF_16BE, WINDOWS_1250, WINDOWS_1252};

pub fn languages() -> Vec<Variant> {
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

pub fn physics() -> Vec<Variant> {
    let with =
        |names: &str, line: fn(usize, [String; 3]) -> Vec<String>| format!("{names}\n{}", P.rows(line));
    let u = |i: usize| pull()[i][1];
    vec![
        v(
            "clock.csv",
            "generic",
            &with("Time,Extension [mm],Load [N]", |i, [_, u, f]| {
                vec![
                    format!(
                        "0:{:02}:{:02}.{:03}",
                        pull()[i][0] / 60_000,
                        pull()[i][0] / 1000 % 60,
                        pull()[i][0] % 1000
                    ),
                    u,
                    f,
                ]
            }),
        ),
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

pub fn looks() -> Vec<Variant> {
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

pub fn books() -> Vec<Variant> {
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
