//! Tests of the JSON decoder.

use super::*;
use crate::ingest::mcap::path::FieldPath;
use crate::ingest::mcap::plan::{AskedField, Plan};
use proptest::prelude::*;

fn decoded(field: &str, text: &str) -> Result<(Value, Value, Option<f64>, Option<String>), String> {
    let plan = Plan::new(&[AskedField::plain(FieldPath::parse(field).unwrap())], &[], |_| true);
    let mut slots = Slots::default();
    slots.clear(plan.count);
    Json(plan.root.clone()).decode(text.as_bytes(), &mut slots)?;
    let field = &plan.fields[0];
    let said = slots.beside(field);
    let stamp = said.stamp.cloned().unwrap_or_default();
    let (rate, unit) = (said.rates.first().map(|rate| rate.value), said.unit.map(String::from));
    Ok((slots.samples(field), stamp, rate, unit))
}

#[test]
fn a_block_gives_samples_stamp_rate_and_unit() {
    let text = r#"{"timestamp":{"sec":2,"nsec":5},"sample_rate_hz":1000,"unit":"g","samples":[1,-2.5,3e2]}"#;
    let (value, stamp, rate, unit) = decoded("samples", text).unwrap();
    assert_eq!(value, Value::Array(Samples::F64(vec![1.0, -2.5, 300.0])));
    assert_eq!(stamp, Value::Stamp(2_000_000_005));
    assert_eq!((rate, unit.as_deref()), (Some(1000.0), Some("g")));
}

#[test]
fn stamps_may_be_text_and_enclose_a_nested_number() {
    let text = r#"{"header":{"stamp":"1970-01-01T00:00:01.5Z"},"x":{"y":[{"z":4}]}}"#;
    let (value, stamp, ..) = decoded("x.y[0].z", text).unwrap();
    assert_eq!(value, Value::Number { value: 4.0, is_narrow: false });
    assert_eq!(stamp, Value::Stamp(1_500_000_000));
}

#[test]
fn null_and_bare_nan_are_nan_and_words_are_an_error() {
    for text in [r#"{"s":[1,null,2]}"#, r#"{"n":"NaN \" ","s":[1,NaN,2]}"#, r#"{"s":[1,-Infinity,2]}"#] {
        let Value::Array(Samples::F64(samples)) = decoded("s", text).unwrap().0 else { panic!("{text}") };
        assert!(samples[1].is_nan(), "{text}");
        assert_eq!((samples[0].to_string(), samples[2].to_string()), ("1".into(), "2".into()), "{text}");
    }
    assert!(decoded("s", r#"{"s":[1,"off"]}"#).unwrap_err().contains("off"));
    assert!(decoded("s", r#"{"s":[1,"#).is_err());
}

#[test]
fn one_element_and_the_whole_array_can_both_be_wanted() {
    let plan = Plan::new(
        &["s[1]", "s"].map(|field| AskedField::plain(FieldPath::parse(field).unwrap())),
        &[],
        |_| true,
    );
    let mut slots = Slots::default();
    slots.clear(plan.count);
    Json(plan.root.clone()).decode(br#"{"s":[7,8]}"#, &mut slots).unwrap();
    assert_eq!(slots.samples(&plan.fields[0]), Value::Number { value: 8.0, is_narrow: false });
    assert_eq!(slots.samples(&plan.fields[1]), Value::Array(Samples::F64(vec![7.0, 8.0])));
}

#[test]
fn leaves_are_the_numbers_without_the_stamp() {
    let text = br#"{"timestamp":{"sec":1,"nsec":2},"a":{"b":1},"s":[1.5,null],"w":"x","o":[{"p":1}]}"#;
    let paths: Vec<(String, bool)> = Fields::of(text)
        .leaves
        .into_iter()
        .filter(|leaf| leaf.is_signal)
        .map(|leaf| (leaf.path, leaf.is_array))
        .collect();
    assert_eq!(paths, [("a.b".to_owned(), false), ("s".to_owned(), true)]);
}

/// What the walk along the text and a tree of all its values make of the same message.
fn both(text: &str) -> (Option<String>, Option<String>) {
    let plan = Plan::new(
        &["s", "a.b", "s2[1]"].map(|field| AskedField::plain(FieldPath::parse(field).unwrap())),
        &[],
        |_| true,
    );
    let mut slots = Slots::default();
    slots.clear(plan.count);
    let walked = Json(plan.root.clone()).walk(text.as_bytes(), &mut slots).ok();
    let values: Vec<Value> = plan.fields.iter().map(|target| slots.samples(target)).collect();
    let of_tree = serde_json::from_str::<Tree>(text).ok().map(|tree| {
        let number = |value: &Tree| value.as_f64().or_else(|| value.is_null().then_some(f64::NAN));
        ["/s", "/a/b", "/s2/1"].map(|place| match tree.pointer(place) {
            Some(Tree::Array(elements)) => {
                Value::Array(Samples::F64(elements.iter().filter_map(number).collect()))
            }
            Some(other) => {
                number(other).map_or(Value::Missing, |value| Value::Number { value, is_narrow: false })
            }
            None => Value::Missing,
        })
    });
    // NaN is not itself, but prints the same.
    (walked.map(|()| format!("{values:?}")), of_tree.map(|values| format!("{values:?}")))
}

#[test]
fn usual_messages_are_walked_along() {
    for text in [
        r#"{"stamp":{"sec":1,"nsec":2},"rate":5e3,"s":[1.5,-2,0,1e-05],"w":"x, {[","a":{"b":3,"c":[{}]}}"#,
        " {\n \"s\" : [ 1 , -0.5 ] , \"s2\": [1, 2, 3], \"n\": null, \"t\": true }\n",
        r#"{"s":[],"a":{},"s2":[null,4],"ä":[[1,2],"]"]}"#,
        r#"{"\u0073":[1,null],"a":{"\"":1,"b":null}}"#,
        "{}",
        "[1]",
    ] {
        let (walked, of_tree) = both(text);
        assert_eq!(walked, of_tree, "{text}");
        assert!(walked.is_some(), "{text}");
    }
}

#[test]
fn numbers_below_elements_and_in_quotes_are_found() {
    let text = r#"{"x":[{"y":[1,"2.5",null]},{"y":"-4"}],"timestamp":{"seconds":"7"}}"#;
    let (value, stamp, ..) = decoded("x[0].y", text).unwrap();
    assert_eq!(format!("{value:?}"), "Array(F64([1.0, 2.5, NaN]))");
    assert_eq!(stamp, Value::Stamp(7_000_000_000));
    let (value, ..) = decoded("x[1].y", text).unwrap();
    assert_eq!(value, Value::Number { value: -4.0, is_narrow: false });
}

#[test]
fn no_text_that_is_no_json_is_walked_to_its_end() {
    for text in [
        r#"{"s":[1,]}"#,
        r#"{"s":[,1]}"#,
        r#"{"s":[01]}"#,
        r#"{"s":[+1]}"#,
        r#"{"s":[.5]}"#,
        r#"{"s":[5.]}"#,
        r#"{"s":[5.e3]}"#,
        r#"{"s":[1 2]}"#,
        r#"{"s":[1}"#,
        r#"{"s":[1]"#,
        r#"{"s":[1],}"#,
        r#"{"s":[1]}}"#,
        r#"{"s" [1]}"#,
        r#"{"s":}"#,
        r"{s:[1]}",
        r#"{"a":{"b":1,},"s":[1]}"#,
        "{\"s\u{1}\":[1]}",
        "",
    ] {
        assert_eq!(both(text), (None, None), "{text}");
    }
}

/// An array that may hold what is no number, an object, a number, a word.
const VALUE: &str =
    r#"(\[-?[0-9]{1,3}(\.[0-9]{0,2})?(e-?[0-9])?(, ?[0-9.]{1,3}){0,2}\]|\{"b":[0-9]\}|[0-9]|"x")"#;

/// A message of up to four fields.
const MESSAGE: &str = r#"\{ ?("s" ?: ?VALUE,?)?("s2" ?: ?VALUE,?)?("a": ?VALUE,?)?("t": ?VALUE)?\}?"#;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2048) })]

    #[test]
    fn the_walk_and_a_tree_of_values_agree_on_any_message(
        text in proptest::string::string_regex(&MESSAGE.replace("VALUE", VALUE)).unwrap(),
    ) {
        let (walked, of_tree) = both(&text);
        prop_assert_eq!(walked, of_tree, "{}", text);
    }
}
