//! A JSON schema of the files, for editors that complete and check while one types.

use crate::keys::{Fallback, Key, Kind, Limits, of};
use crate::read::{key_of, keys_of_law, option_key};
use crate::registry::{EffectRegistry, LawSite};
use serde_json::{Map, Value, json};

/// JSON schema (draft 2020-12) of specimens and configurations, effects as the catalogue has them.
pub fn json_schema(registry: &dyn EffectRegistry) -> Value {
    let mut effects = Map::new();
    for name in registry.names() {
        let section = format!("effects.{name}");
        let specs = registry.parameters(name).unwrap_or_default();
        let mut keys: Vec<Key> = specs.iter().map(|s| key_of(section.clone(), s)).collect();
        keys.extend(registry.options(name).iter().map(|o| option_key(section.clone().into(), o)));
        effects.insert(name.to_owned(), object(&keys));
    }
    let mut schema = object(&of(""));
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("fct: specimen and configuration");
    schema["properties"]["effects"]["properties"] = Value::Object(effects);
    let kinds: Vec<&str> = registry.kinds().iter().map(|k| k.word()).collect();
    let kind = &mut schema["properties"]["tests"]["items"]["properties"]["kind"];
    *kind = json!({ "enum": kinds, "description": kind["description"] });
    for site in LawSite::ALL {
        let description = schema["properties"][site.section()]["description"].take();
        schema["properties"][site.section()] = of_laws(site, registry);
        schema["properties"][site.section()]["description"] = description;
    }
    schema
}

/// The section of a site: the keys of all laws, and for each law which of them it takes.
fn of_laws(site: LawSite, registry: &dyn EffectRegistry) -> Value {
    let names = registry.law_names(site);
    let common = of(site.section());
    let mut keys = common.clone();
    let mut each = Vec::new();
    for (index, law) in names.iter().enumerate() {
        let own = keys_of_law(registry, site, law);
        let spelt = common.iter().chain(&own).flat_map(Key::spellings).map(|s| s.0);
        let takes = json!({ "propertyNames": { "enum": spelt.collect::<Vec<_>>() } });
        let mut named = json!({ "properties": { "law": { "const": law } } });
        // Without `law` it is the first.
        if index > 0 {
            named["required"] = json!(["law"]);
        }
        each.push(json!({ "if": named, "then": takes }));
        keys.extend(own);
    }
    let mut seen = std::collections::BTreeSet::new();
    keys.retain(|k| seen.insert(k.spelling()));
    let mut out = object(&keys);
    out["properties"]["law"]["enum"] = json!(names);
    if let Some(first) = names.first() {
        out["properties"]["law"]["default"] = json!(first);
    }
    out["allOf"] = Value::Array(each);
    out
}

/// A table with these keys and no others; every spelling of a key is a property.
fn object(keys: &[Key]) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for key in keys {
        let spellings = key.spellings();
        for (spelling, factor) in &spellings {
            let mut property = of_key(key, spelling, *factor);
            property["description"] = json!(key.description);
            if let Some(default) = default(&key.default, *factor) {
                property["default"] = default;
            }
            properties.insert(spelling.clone(), property);
        }
        if key.default == Fallback::Required {
            let any: Vec<Value> = spellings.iter().map(|(s, _)| json!({ "required": [s] })).collect();
            required.push(json!({ "anyOf": any }));
        }
    }
    let mut out = json!({ "type": "object", "additionalProperties": false, "properties": properties });
    if !required.is_empty() {
        out["allOf"] = Value::Array(required);
    }
    out
}

fn default(fallback: &Fallback, factor: f64) -> Option<Value> {
    match fallback {
        Fallback::Number(x) => Some(json!(x / factor)),
        Fallback::Integer(i) => Some(json!(i)),
        Fallback::Bool(b) => Some(json!(b)),
        Fallback::Word(w) => Some(json!(w)),
        Fallback::Required | Fallback::Absent(_) => None,
    }
}

fn number(limits: &Limits, factor: f64) -> Value {
    let mut out = json!({ "type": "number" });
    if limits.lower.is_finite() {
        out[if limits.above { "exclusiveMinimum" } else { "minimum" }] = json!(limits.lower / factor);
    }
    if limits.upper.is_finite() {
        out[if limits.below { "exclusiveMaximum" } else { "maximum" }] = json!(limits.upper / factor);
    }
    out
}

fn parameter(limits: &Limits, factor: f64, list: bool) -> Value {
    let bare = number(limits, factor);
    let bound = number(&Limits { above: false, below: false, ..*limits }, factor);
    let fields = json!({
        "start": bare, "value": bare, "min": bound, "max": bound, "fixed": { "type": "boolean" }
    });
    let table = json!({ "type": "object", "additionalProperties": false, "properties": fields });
    let one = json!([bare, table]);
    if list {
        json!({ "anyOf": [bare, table, { "type": "array", "items": { "anyOf": one } }] })
    } else {
        json!({ "anyOf": one })
    }
}

fn of_key(key: &Key, spelling: &str, factor: f64) -> Value {
    match &key.kind {
        Kind::Bool => json!({ "type": "boolean" }),
        Kind::Text | Kind::File => json!({ "type": "string" }),
        Kind::Rows { .. } if spelling == key.name => json!({ "type": ["string", "array"] }),
        Kind::Rows { columns, .. } => {
            let row = json!({ "type": "array", "items": { "type": "number" }, "minItems": columns, "maxItems": columns });
            json!({ "type": "array", "items": row })
        }
        Kind::Choice { words } => json!({ "enum": words }),
        Kind::Words { words } => json!({ "type": ["array", "string"], "items": { "enum": words } }),
        Kind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Count { max } => json!({ "type": ["integer", "boolean"], "minimum": 0, "maximum": max }),
        Kind::Divisions => {
            json!({ "type": "array", "items": { "type": "integer", "minimum": 1 }, "minItems": 3, "maxItems": 3 })
        }
        Kind::Number { limits, .. } => number(limits, factor),
        Kind::Parameter { limits, list, .. } => parameter(limits, factor, *list),
        Kind::Priors => json!({ "type": ["boolean", "string", "object"] }),
        Kind::Legs => json!({ "type": "array", "minItems": 1, "items": object(&of("tests.protocol")) }),
        Kind::Weights => json!({ "type": "array", "items": object(&of("tests.weights")) }),
        Kind::Table if key.name == "effects" => json!({ "type": "object", "additionalProperties": false }),
        Kind::Table => object(&of(&key.name)),
        Kind::Tables => json!({ "type": "array", "minItems": 1, "items": object(&of(&key.name)) }),
    }
}
