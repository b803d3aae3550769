//! Workbooks of a few cells, byte by byte: no library writes them here, so that reading is not tested against itself.

use std::fmt::Write;

/// A cell.
#[derive(Clone, Debug)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number as it is written in the file.
    Number(String),
    /// Nothing.
    Empty,
}

/// Rows of cells.
pub type Sheet = Vec<Vec<Cell>>;

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |mut c, b| {
        c ^= u32::from(*b);
        for _ in 0..8 {
            c = if c & 1 == 1 { (c >> 1) ^ 0xEDB8_8320 } else { c >> 1 };
        }
        c
    })
}

/// A zip file without compression.
pub fn zip(files: &[(&str, String)]) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let at = out.len() as u32;
        let size = (content.len() as u32).to_le_bytes();
        let mut common = Vec::new();
        common.extend([20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0]);
        common.extend(crc(content.as_bytes()).to_le_bytes());
        common.extend([size, size].concat());
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        out.extend(b"PK\x03\x04");
        out.extend(&common);
        out.extend(name.as_bytes());
        out.extend(content.as_bytes());
        directory.extend(b"PK\x01\x02\x14\0");
        directory.extend(&common);
        directory.extend([0; 10]);
        directory.extend(at.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (count, start) = ((files.len() as u16).to_le_bytes(), out.len() as u32);
    out.extend(&directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    out.extend([count, count].concat());
    out.extend((directory.len() as u32).to_le_bytes());
    out.extend(start.to_le_bytes());
    out.extend([0, 0]);
    out
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// An Office Open XML workbook.
pub fn xlsx(sheets: &[(&str, Sheet)]) -> Vec<u8> {
    const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>";
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const REL: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
    let (mut types, mut list, mut relations) = (String::new(), String::new(), String::new());
    let mut files = Vec::new();
    for (k, (name, rows)) in sheets.iter().enumerate() {
        let k = k + 1;
        let _ = write!(
            types,
            "<Override PartName=\"/xl/worksheets/sheet{k}.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml\"/>"
        );
        let _ = write!(list, "<sheet name=\"{}\" sheetId=\"{k}\" r:id=\"rId{k}\"/>", escaped(name));
        let _ = write!(
            relations,
            "<Relationship Id=\"rId{k}\" Type=\"{REL}/worksheet\" Target=\"worksheets/sheet{k}.xml\"/>"
        );
        let mut data = String::new();
        for (r, row) in rows.iter().enumerate() {
            let _ = write!(data, "<row r=\"{}\">", r + 1);
            for (c, cell) in row.iter().enumerate() {
                let place = format!("{}{}", (b'A' + c as u8) as char, r + 1);
                let _ = match cell {
                    Cell::Text(t) => {
                        write!(data, "<c r=\"{place}\" t=\"inlineStr\"><is><t>{}</t></is></c>", escaped(t))
                    }
                    Cell::Number(n) => write!(data, "<c r=\"{place}\"><v>{n}</v></c>"),
                    Cell::Empty => Ok(()),
                };
            }
            data.push_str("</row>");
        }
        files.push((
            format!("xl/worksheets/sheet{k}.xml"),
            format!("{HEAD}<worksheet xmlns=\"{MAIN}\"><sheetData>{data}</sheetData></worksheet>"),
        ));
    }
    let mut all = vec![
        (
            "[Content_Types].xml".to_owned(),
            format!(
                "{HEAD}<Types xmlns=\"{PACKAGE}/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"xml\" ContentType=\"application/xml\"/><Override PartName=\"/xl/workbook.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml\"/>{types}</Types>"
            ),
        ),
        (
            "_rels/.rels".to_owned(),
            format!(
                "{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"rId1\" Type=\"{REL}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml".to_owned(),
            format!("{HEAD}<workbook xmlns=\"{MAIN}\" xmlns:r=\"{REL}\"><sheets>{list}</sheets></workbook>"),
        ),
        (
            "xl/_rels/workbook.xml.rels".to_owned(),
            format!("{HEAD}<Relationships xmlns=\"{PACKAGE}/relationships\">{relations}</Relationships>"),
        ),
    ];
    all.extend(files);
    let all: Vec<(&str, String)> = all.iter().map(|(n, c)| (n.as_str(), c.clone())).collect();
    zip(&all)
}

/// An OpenDocument spreadsheet.
pub fn ods(sheets: &[(&str, Sheet)]) -> Vec<u8> {
    let mut tables = String::new();
    for (name, rows) in sheets {
        let _ = write!(tables, "<table:table table:name=\"{}\">", escaped(name));
        for row in rows {
            tables.push_str("<table:table-row>");
            for cell in row {
                let _ = match cell {
                    Cell::Text(t) => write!(
                        tables,
                        "<table:table-cell office:value-type=\"string\"><text:p>{}</text:p></table:table-cell>",
                        escaped(t)
                    ),
                    Cell::Number(n) => write!(
                        tables,
                        "<table:table-cell office:value-type=\"float\" office:value=\"{n}\"><text:p>{n}</text:p></table:table-cell>"
                    ),
                    Cell::Empty => write!(tables, "<table:table-cell/>"),
                };
            }
            tables.push_str("</table:table-row>");
        }
        tables.push_str("</table:table>");
    }
    let urn = "urn:oasis:names:tc:opendocument:xmlns";
    let content = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><office:document-content xmlns:office=\"{urn}:office:1.0\" xmlns:table=\"{urn}:table:1.0\" xmlns:text=\"{urn}:text:1.0\" office:version=\"1.2\"><office:body><office:spreadsheet>{tables}</office:spreadsheet></office:body></office:document-content>"
    );
    let manifest = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><manifest:manifest xmlns:manifest=\"{urn}:manifest:1.0\"><manifest:file-entry manifest:full-path=\"/\" manifest:media-type=\"application/vnd.oasis.opendocument.spreadsheet\"/><manifest:file-entry manifest:full-path=\"content.xml\" manifest:media-type=\"text/xml\"/></manifest:manifest>"
    );
    zip(&[
        ("mimetype", "application/vnd.oasis.opendocument.spreadsheet".into()),
        ("META-INF/manifest.xml", manifest),
        ("content.xml", content),
    ])
}

/// An Excel 97 workbook with one sheet: BIFF8 records in a compound file.
pub fn xls(name: &str, rows: &Sheet) -> Vec<u8> {
    let record =
        |kind: u16, body: &[u8]| [&kind.to_le_bytes()[..], &(body.len() as u16).to_le_bytes(), body].concat();
    let bof = |kind: u16| {
        record(
            0x0809,
            &[&[0, 6][..], &kind.to_le_bytes(), &[0xBB, 0x0D, 0xCC, 0x07, 0, 0, 0, 0, 6, 0, 0, 0]].concat(),
        )
    };
    let mut cells = bof(0x0010);
    for (r, row) in rows.iter().enumerate() {
        for (c, cell) in row.iter().enumerate() {
            let place = [(r as u16).to_le_bytes(), (c as u16).to_le_bytes(), [0, 0]].concat();
            match cell {
                Cell::Number(n) => {
                    let x: f64 = n.parse().expect("a number");
                    cells.extend(record(0x0203, &[&place[..], &x.to_le_bytes()].concat()));
                }
                Cell::Text(t) => {
                    let letters: Vec<u8> = t.encode_utf16().flat_map(u16::to_le_bytes).collect();
                    let length = ((letters.len() / 2) as u16).to_le_bytes();
                    cells.extend(record(0x0204, &[&place[..], &length, &[1], &letters].concat()));
                }
                Cell::Empty => {}
            }
        }
    }
    cells.extend(record(0x000A, &[]));
    let sheet = |at: u32| {
        record(0x0085, &[&at.to_le_bytes()[..], &[0, 0, name.len() as u8, 0], name.as_bytes()].concat())
    };
    let globals = |at: u32| [bof(0x0005), sheet(at), record(0x000A, &[])].concat();
    let at = globals(0).len() as u32;
    let mut stream = [globals(at), cells].concat();
    // Shorter streams would live in another kind of sectors.
    stream.resize(stream.len().max(4096).next_multiple_of(512), 0);
    compound(&stream)
}

/// A compound file with one stream, `Workbook`: sector 0 is the table, 1 the directory, the rest the stream.
fn compound(stream: &[u8]) -> Vec<u8> {
    let sectors = stream.len() / 512;
    assert!(sectors < 120, "one sector of the table is enough");
    let mut out = b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1".to_vec();
    out.extend([0; 16]);
    out.extend([0x3E, 0, 3, 0, 0xFE, 0xFF, 9, 0, 6, 0, 0, 0, 0, 0, 0, 0]);
    let number = |x: i64| (x as u32).to_le_bytes();
    let fields = [0, 1, 1, 0, 4096, -2, 0, -2, 0, 0];
    fields.iter().for_each(|x| out.extend(number(*x)));
    (0..108).for_each(|_| out.extend(number(-1)));
    let chain = (0..sectors as i64).map(|k| if k + 1 == sectors as i64 { -2 } else { k + 3 });
    let table: Vec<i64> = [-3, -2].into_iter().chain(chain).chain(std::iter::repeat(-1)).take(128).collect();
    table.iter().for_each(|x| out.extend(number(*x)));
    let entry = |name: &str, kind: u8, child: i64, start: i64, size: usize| {
        let mut e: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
        e.resize(64, 0);
        let letters = if name.is_empty() { 0 } else { 2 * (name.len() + 1) };
        e.extend((letters as u16).to_le_bytes());
        e.extend([kind, 1]);
        [-1, -1, child].iter().for_each(|x| e.extend(number(*x)));
        e.extend([0; 36]);
        e.extend(number(start));
        e.extend((size as u64).to_le_bytes());
        e
    };
    out.extend(entry("Root Entry", 5, 1, -2, 0));
    out.extend(entry("Workbook", 2, -1, 2, stream.len()));
    (0..2).for_each(|_| out.extend(entry("", 0, -1, 0, 0)));
    out.extend(stream);
    out
}
