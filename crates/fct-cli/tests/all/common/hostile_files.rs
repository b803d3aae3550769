//! Hostile files, the same every time.

/// A config that is right, with a record beside it.
pub const CONFIG: &str = r#"name = "strip"
[geometry]
length_mm = 8.0
width_mm = 6.0
thickness_mm = 0.8
cut_mm = 1.5
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 1.0, rate_mm_per_s = 0.05 }, { hold_s = 5.0 }]
[[tests]]
kind = "tearing"
data = "record.csv"
[mesh]
divisions = [4, 4, 1]
[bulk]
mu_kPa = { start = 6.0, min = 1.0, max = 50.0 }
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
[interface]
areas = 2
gc_N_per_mm = [0.15, 0.2]
sigma_c_MPa = 0.08
[effects.viscoelastic]
g = 0.1
tau_s = 12.0
[identify]
max_iterations = 2
[solver]
step_mm = 0.25
[output]
fields = false
figures = ["svg"]
"#;

/// A record of so many rows.
pub fn record(rows: usize) -> String {
    let mut out = String::from("time_s,displacement_mm,force_N\n");
    for i in 0..rows {
        let u = 5.0 * i as f64 / rows as f64;
        let noise = 1e-3 * ((i * 7919) % 13) as f64 / 6.0;
        out.push_str(&format!("{i},{u},{}\n", 0.25 * (u / 3.0).powi(2) * (-(u / 3.5).powi(6)).exp() + noise));
    }
    out
}

/// Numbers in a row that look like chance and are always the same.
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }

    /// Some bytes changed, taken out, repeated.
    fn damaged(&mut self, text: &str) -> Vec<u8> {
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=self.below(12) {
            let at = self.below(bytes.len());
            match self.below(5) {
                0 => bytes[at] = self.below(256) as u8,
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, b"0123456789eE.-+[]{}=\"'#\n,"[self.below(25)]),
                3 => {
                    let end = (at + self.below(40)).min(bytes.len());
                    let piece = bytes[at..end].to_vec();
                    let to = self.below(bytes.len());
                    bytes.splice(to..to, piece);
                }
                _ => bytes.truncate(at.max(1)),
            }
        }
        bytes
    }
}

/// A config and a record.
pub struct Case {
    pub what: String,
    pub config: Vec<u8>,
    pub record: Vec<u8>,
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let mut out = Vec::new();
    let (good, mut chance) = (record(60), Chance(26));
    let mut add = |what: String, config: Vec<u8>, record: Vec<u8>| out.push(Case { what, config, record });
    for i in 0..110 {
        add(format!("damaged config {i}"), chance.damaged(CONFIG), good.clone().into());
    }
    for i in 1..40 {
        add(
            format!("config cut at {i}/40"),
            CONFIG.as_bytes()[..CONFIG.len() * i / 40].to_vec(),
            good.clone().into(),
        );
    }
    for i in 0..80 {
        add(format!("damaged record {i}"), CONFIG.into(), chance.damaged(&good));
    }
    for i in 1..20 {
        add(format!("record cut at {i}/20"), CONFIG.into(), good.as_bytes()[..good.len() * i / 20].to_vec());
    }
    for (i, text) in odd_numbers().into_iter().enumerate() {
        add(format!("odd number {i}"), text.into(), good.clone().into());
    }
    for (what, text) in odd_configs() {
        add(what, text, good.clone().into());
    }
    for (what, text) in odd_records() {
        add(what, CONFIG.into(), text);
    }
    for (effect, text) in odd_effects() {
        add(effect, text.into(), good.clone().into());
    }
    out
}

/// Every number of the config in turn replaced.
fn odd_numbers() -> Vec<String> {
    let odd = [
        "1e308",
        "-1e308",
        "1e-308",
        "1e-154",
        "0",
        "-1",
        "nan",
        "inf",
        "99999999999999999999",
        "0x7fff",
        "1e3000",
    ];
    let sites: Vec<usize> = CONFIG.match_indices(" = ").map(|m| m.0 + 3).collect();
    let number = |at: usize| CONFIG[at..].chars().take_while(|c| c.is_ascii_digit() || *c == '.').count();
    let sites = sites.into_iter().filter(|&at| number(at) > 0);
    let replaced = |(i, at): (usize, usize)| {
        let mut text = CONFIG.to_owned();
        text.replace_range(at..at + number(at), odd[i % odd.len()]);
        let mut again = CONFIG.to_owned();
        again.replace_range(at..at + number(at), odd[(i * 5 + 3) % odd.len()]);
        [text, again]
    };
    sites.enumerate().flat_map(replaced).collect()
}

fn odd_configs() -> Vec<(String, Vec<u8>)> {
    let text = |what: &str, text: String| (what.to_owned(), text.into_bytes());
    let with = |more: &str| format!("{CONFIG}\n{more}\n");
    let mut out = vec![
        text("mark before the text", format!("\u{FEFF}{CONFIG}")),
        text("two marks", format!("\u{FEFF}\u{FEFF}{CONFIG}")),
        text("lines end as on Windows", CONFIG.replace('\n', "\r\n")),
        text("lines end as on old Macs", CONFIG.replace('\n', "\r")),
        text("a zero byte", CONFIG.replace("strip", "st\0rip")),
        text("nothing", String::new()),
        text("blanks", " \n\t\n".repeat(100)),
        text("only comments", "# nothing\n".repeat(1000)),
        text("one line of a megabyte", with(&format!("# {}", "x".repeat(1_000_000)))),
        text("a key of a megabyte", with(&format!("{} = 1", "k".repeat(1_000_000)))),
        text("a name of a megabyte", CONFIG.replace("\"strip\"", &format!("\"{}\"", "n".repeat(1_000_000)))),
        text("eleven megabytes", with(&"# x\n".repeat(2_750_000))),
        text("lists in lists", with(&format!("x = {}{}", "[".repeat(50_000), "]".repeat(50_000)))),
        text("tables in tables", with(&format!("x = {}1{}", "{ a = ".repeat(20_000), " }".repeat(20_000)))),
        text("dots", with(&format!("{}x = 1", "a.".repeat(20_000)))),
        text("sections in sections", with(&format!("[{}x]", "a.".repeat(20_000)))),
        text("keys twice", with(&"[bulk]\nmu_kPa = 1\n".repeat(1000))),
        text(
            "a hundred thousand tests",
            with(&"[[tests]]\nkind = \"uniaxial\"\ndata = \"record.csv\"\n".repeat(100_000)),
        ),
        text(
            "a thousand tests",
            with(&"[[tests]]\nkind = \"uniaxial\"\ndata = \"record.csv\"\n".repeat(900)),
        ),
        text(
            "a hundred thousand legs",
            CONFIG.replace(
                "{ hold_s = 5.0 }",
                &"{ to_mm = 2.0, rate_mm_per_s = 1.0 }, { to_mm = 1.0, rate_mm_per_s = 1.0 }, "
                    .repeat(50_000),
            ),
        ),
        text(
            "a hundred thousand strengths",
            CONFIG.replace("[0.15, 0.2]", &format!("[{}]", "0.1, ".repeat(100_000))),
        ),
        text("a thousand areas", CONFIG.replace("areas = 2", "areas = 1000").replace("[0.15, 0.2]", "0.15")),
        text("fine", CONFIG.replace("[4, 4, 1]", "[200, 200, 20]")),
        text("finer", CONFIG.replace("divisions = [4, 4, 1]", "path_size_mm = 0.002")),
        text("thin", CONFIG.replace("[4, 4, 1]", "[20000, 2, 1]")),
        text("the shortest step", CONFIG.replace("step_mm = 0.25", "step_mm = 1e-6")),
        text("many starts", CONFIG.replace("max_iterations = 2", "max_iterations = 1\nmulti_start = 10000")),
        text(
            "an outline of many rows",
            CONFIG.replace(
                "cut_mm = 1.5",
                &format!(
                    "cut_mm = 1.5\noutline_mm = [{}]",
                    (0..50_000)
                        .map(|i| format!("[{}, 0, 6], ", f64::from(i) * 8.0 / 49_999.0))
                        .collect::<String>()
                ),
            ),
        ),
        text(
            "an outline that folds",
            CONFIG
                .replace("cut_mm = 1.5", "cut_mm = 1.5\noutline_mm = [[0, 0, 6], [4, 5.9999, 6], [8, 0, 6]]"),
        ),
        text("control characters", with("\u{1b}[2J = 1")),
        text("a path through itself", CONFIG.replace("record.csv", &"../".repeat(2000))),
    ];
    out.push(("UTF-16".to_owned(), CONFIG.encode_utf16().flat_map(u16::to_le_bytes).collect()));
    out.push((
        "Latin 1".to_owned(),
        CONFIG.replace("strip", "str\u{ef}p").chars().map(|c| c as u8).collect(),
    ));
    out.push(("every byte".to_owned(), (0..=255u8).cycle().take(10_000).collect()));
    out.push(("zeros".to_owned(), vec![0; 1_000_000]));
    out
}

fn odd_records() -> Vec<(String, Vec<u8>)> {
    let good = record(60);
    let row = |at: usize, with: &str| {
        let mut lines: Vec<&str> = good.lines().collect();
        lines[at] = with;
        lines.join("\n")
    };
    let text = |what: &str, text: String| (what.to_owned(), text.into_bytes());
    let head = "time_s,displacement_mm,force_N\n";
    vec![
        text("a spike", row(30, "29,2.4,1e6")),
        text("a force of 1e300", row(30, "29,2.4,1e300")),
        text("a force of 1e308 MN", good.replace("force_N", "force_kN").replace(",0.0\n", ",1e308\n")),
        text("a time of 1e300", row(59, "1e300,4.9,0.1")),
        text(
            "times of 1e-300",
            (0..60).fold(head.to_owned(), |t, i| t + &format!("{i}e-300,{i}e-2,0.{i}\n")),
        ),
        text(
            "displacements of 1e-300",
            (0..60).fold(head.to_owned(), |t, i| t + &format!("{i},{i}e-300,0.{i}\n")),
        ),
        text("forces of 1e-300", (0..60).fold(head.to_owned(), |t, i| t + &format!("{i},{i}e-2,{i}e-300\n"))),
        text("no force at all", (0..60).fold(head.to_owned(), |t, i| t + &format!("{i},{i}e-2,0\n"))),
        text("one force", (0..60).fold(head.to_owned(), |t, i| t + &format!("{i},{i}e-2,1\n"))),
        text("to and fro", (0..3000).fold(head.to_owned(), |t, i| t + &format!("{i},{},{}\n", i % 2, i % 2))),
        text("a million commas", format!("{head}{}\n", ",".repeat(1_000_000))),
        text("a quote that never ends", format!("{head}\"{}", "x".repeat(50_000))),
        text("a thousand columns", format!("{}\n{}\n", "a,".repeat(1000), "1,".repeat(1000))),
        text("semicolons", good.replace(',', ";")),
        text("tabs", good.replace(',', "\t")),
        text("decimal commas", good.replace('.', ",")),
        text("lines end as on Windows", good.replace('\n', "\r\n")),
        text("lines end as on old Macs", good.replace('\n', "\r")),
        text("a mark before the text", format!("\u{FEFF}{good}")),
        text("zero bytes", good.replace("\n5,", "\n\0")),
        text("every column twice", good.lines().map(|l| format!("{l},{l}\n")).collect()),
        text("only a header", head.to_owned()),
        text("two rows", format!("{head}0,0,0\n1,1,1\n")),
        text("three rows", format!("{head}0,0,0\n1,1,1\n2,2,2\n")),
        text("a hundred thousand bad rows", format!("{head}{}", "x,y,z\n".repeat(100_000))),
        text("two hundred thousand rows", record(200_000)),
        text("backwards", good.lines().rev().map(|l| format!("{l}\n")).collect()),
        text("empty cells", good.replace(",0.", ",,0.")),
    ]
}

/// Effects with what does not belong to them.
fn odd_effects() -> Vec<(String, String)> {
    let base = CONFIG.replace("[effects.viscoelastic]\ng = 0.1\ntau_s = 12.0\n", "");
    let catalogue = effects::catalogue();
    let known: Vec<&str> = catalogue.iter().map(|e| e.card().name).collect();
    let names: Vec<&str> = known.iter().copied().chain(["no_such_effect"]).collect();
    let bodies = [
        "branches = 1000000",
        "test = \"nowhere\"\nbranches = -1",
        "x = { start = nan }",
        "g = [[1]]\ntau_s = \"a\"",
    ];
    let mut out: Vec<_> = names
        .iter()
        .enumerate()
        .flat_map(|(i, name)| {
            let body = |k: usize| bodies[(i + k) % bodies.len()];
            [0, 1].map(|k| (format!("{name} {k}"), format!("{base}[effects.{name}]\n{}\n", body(k))))
        })
        .collect();
    let all: String = known.iter().map(|n| format!("[effects.{n}]\n")).collect();
    out.push(("every effect".to_owned(), format!("{base}{all}")));
    out.push(("effects = 1".to_owned(), format!("effects = 1\n{base}")));
    out
}
