//! Values of JSON libraries: objects, numbers and texts by their keys.

use serde_json::{Map, Value};

pub(super) type Object = Map<String, Value>;

/// The memory that the values of a text may take, in bytes.
const MAX_MEMORY: usize = 640 << 20;

/// Returns the value of a text.
///
/// # Errors
/// If it is no JSON, or its values would take much memory, which few bytes can ask for.
pub(super) fn parse(text: &str) -> Result<Value, String> {
    // An object takes at least a node of a tree, and a value 32 bytes in a list that may have grown to twice its length.
    let count = |wanted: &[u8]| text.bytes().filter(|byte| wanted.contains(byte)).count();
    let memory = 700 * count(b"{") + 64 * count(b",[");
    if memory > MAX_MEMORY {
        return Err(format!("its values may take {} MiB of memory: split it", memory >> 20));
    }
    serde_json::from_str(text).map_err(|error| error.to_string())
}

/// Returns the object of a key, if there is one.
pub(super) fn object<'a>(value: &'a Object, key: &str) -> Result<Option<&'a Object>, String> {
    match value.get(key) {
        None | Some(Value::Null) => Ok(None),
        Some(Value::Object(object)) => Ok(Some(object)),
        Some(_) => Err(format!("its `{key}` is no object")),
    }
}

/// Returns a tool number, which some libraries have as a text or with decimals.
pub(super) fn tool_number(value: &Value) -> Option<u32> {
    let number = number(value)? as u32;
    (f64::from(number) == self::number(value)?).then_some(number)
}

/// Returns a finite number of an object.
pub(super) fn number_of(object: &Object, key: &str) -> Option<f64> {
    object.get(key).and_then(number)
}

/// Returns a finite number. Some libraries have numbers as texts.
pub(super) fn number(value: &Value) -> Option<f64> {
    let stated = value.as_f64().or_else(|| value.as_str()?.trim().parse().ok());
    stated.filter(|number| number.is_finite())
}

/// Returns a text of an object without blanks around it; empty if there is none.
pub(super) fn string<'a>(object: &'a Object, key: &str) -> &'a str {
    object.get(key).and_then(Value::as_str).unwrap_or("").trim()
}

/// Returns the first two numbers of a list.
pub(super) fn pair(value: &Value) -> Option<[f64; 2]> {
    let list = value.as_array()?;
    let [first, second] = [0, 1].map(|k| list.get(k)?.as_f64().filter(|number| number.is_finite()));
    Some([first?, second?])
}
