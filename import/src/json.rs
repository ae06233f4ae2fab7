//! Values of JSON libraries: objects, numbers and texts by their keys.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::collections::HashSet;
use std::fmt;

pub(super) type Object = Map<String, Value>;

/// The memory that the values of a text may take, in bytes.
const MAX_MEMORY: usize = 640 << 20;

/// Returns the value of a text.
///
/// # Errors
/// If it is no JSON, if an object has a key twice, or if its values would take much memory, which few bytes can ask for.
pub(super) fn parse(text: &str) -> Result<Value, String> {
    // An object takes at least a node of a tree, and a value 32 bytes in a list that may have grown to twice its length.
    let count = |wanted: &[u8]| text.bytes().filter(|byte| wanted.contains(byte)).count();
    let memory = 700 * count(b"{") + 64 * count(b",[");
    if memory > MAX_MEMORY {
        return Err(format!("its values may take {} MiB of memory: split it", memory >> 20));
    }
    let value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    serde_json::from_str::<Distinct>(text).map_err(|error| error.to_string())?;
    Ok(value)
}

/// A value in which no object has a key twice. [`Value`] keeps the last of them.
struct Distinct;

impl<'de> Deserialize<'de> for Distinct {
    fn deserialize<D: Deserializer<'de>>(value: D) -> Result<Distinct, D::Error> {
        value.deserialize_any(Distinct)
    }
}

impl<'de> Visitor<'de> for Distinct {
    type Value = Distinct;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut object: A) -> Result<Distinct, A::Error> {
        let mut keys = HashSet::new();
        while let Some(key) = object.next_key::<String>()? {
            object.next_value::<Distinct>()?;
            if let Some(second) = keys.replace(key) {
                return Err(A::Error::custom(format!("an object has the key `{second}` twice")));
            }
        }
        Ok(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Distinct, A::Error> {
        while list.next_element::<Distinct>()?.is_some() {}
        Ok(self)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Distinct, E> {
        Ok(self)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Distinct, E> {
        Ok(self)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Distinct, E> {
        Ok(self)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Distinct, E> {
        Ok(self)
    }

    fn visit_str<E>(self, _: &str) -> Result<Distinct, E> {
        Ok(self)
    }

    fn visit_unit<E>(self) -> Result<Distinct, E> {
        Ok(self)
    }
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

/// Returns a truth. Some libraries have them as texts.
pub(super) fn truth(value: &Value) -> Option<bool> {
    value.as_bool().or_else(|| value.as_str()?.trim().parse().ok())
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
