//! Tests of the JSON decoder.

use super::*;
use crate::ingest::mcap::path::FieldPath;

fn decoded(field: &str, text: &str) -> Result<(Value, Value, Option<f64>, Option<String>), String> {
    let plan = Plan::new(&[FieldPath::parse(field).unwrap()]);
    let mut slots = Slots::default();
    slots.clear(plan.wants.len());
    Json::new(&plan).decode(text.as_bytes(), &mut slots)?;
    let target = &plan.targets[0];
    let (stamp, rate, unit) =
        (slots.stamp(target), slots.rate_hz(target), slots.unit(target).map(String::from));
    Ok((slots.samples(target), stamp, rate, unit))
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
    let plan = Plan::new(&["s[1]", "s"].map(|field| FieldPath::parse(field).unwrap()));
    let mut slots = Slots::default();
    slots.clear(plan.wants.len());
    Json::new(&plan).decode(br#"{"s":[7,8]}"#, &mut slots).unwrap();
    assert_eq!(slots.samples(&plan.targets[0]), Value::Number { value: 8.0, is_narrow: false });
    assert_eq!(slots.samples(&plan.targets[1]), Value::Array(Samples::F64(vec![7.0, 8.0])));
}

#[test]
fn leaves_are_the_numbers_without_the_stamp() {
    let text = br#"{"timestamp":{"sec":1,"nsec":2},"a":{"b":1},"s":[1.5,null],"w":"x","o":[{"p":1}]}"#;
    let paths: Vec<(String, bool)> =
        leaves(text).into_iter().map(|leaf| (leaf.path, leaf.is_array)).collect();
    assert_eq!(paths, [("a.b".to_owned(), false), ("s".to_owned(), true)]);
}
