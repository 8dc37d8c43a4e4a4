//! Logs of CAN frames: `candump -L`, and SavvyCAN's CSV. A description in DBC says which signals the frames hold.

use std::collections::{BTreeSet, HashMap};

use can_dbc::Dbc;

use super::Format;
use super::dbc::{Description, described};
use super::fault::Fault;
use super::gather::{Gather, Value};
use super::log::Log;

/// Most bytes of a frame: those of CAN FD.
const MAX_BYTES: usize = 64;
/// Identifiers that are named where the description does not have them.
const MOST_NAMED: usize = 64;
/// The bit by which a DBC tells an identifier of 29 bits.
const EXTENDED: u32 = 1 << 31;
/// How SavvyCAN's first line begins.
const SAVVYCAN: &[u8] = b"Time Stamp,ID,Extended,";

/// A frame.
struct Frame {
    stamp_s: f64,
    /// As a DBC has it.
    id: u32,
    bytes: Vec<u8>,
}

/// What a line holds.
enum Line {
    Frame(Frame),
    /// A frame without data: a request, or an error of the bus.
    NoData,
}

/// Whether a file begins as one of these logs does.
pub(super) fn begins(head: &[u8]) -> bool {
    if head.starts_with(SAVVYCAN) {
        return true;
    }
    let text = String::from_utf8_lossy(head);
    let stamp = text.trim_start().strip_prefix('(').and_then(|text| text.split_once(')'));
    stamp.is_some_and(|(stamp, rest)| stamp.parse::<f64>().is_ok() && rest.starts_with(' '))
}

/// Reads the frames that `dbc` describes.
pub(super) fn read(bytes: &[u8], dbc: Option<&Dbc>) -> Result<Log, Fault> {
    let Some(dbc) = dbc else {
        let what = "a CAN log without a description of its frames".to_owned();
        return Err(Fault::Unsupported { what, instead: "give the frames' DBC file with --dbc" });
    };
    let messages = described(dbc);
    let savvycan = bytes.starts_with(SAVVYCAN);
    let frame_of = if savvycan { savvycan_frame } else { candump_frame };
    let (mut gather, mut groups, mut unknown) = (Gather::default(), HashMap::new(), BTreeSet::new());
    let (mut at, mut torn_at) = (0, None);
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let began = at;
        at += line.len();
        let text = String::from_utf8_lossy(line);
        let text = text.trim();
        if text.is_empty() || (savvycan && began == 0) {
            continue;
        }
        match frame_of(text) {
            Some(Line::Frame(frame)) => match messages.get(&frame.id) {
                Some(message) => add(&mut gather, &mut groups, &frame, message)?,
                None => {
                    unknown.insert(frame.id);
                }
            },
            Some(Line::NoData) => {}
            // The logger was stopped in the middle of a line.
            None if at == bytes.len() && began > 0 => torn_at = Some(began as u64),
            None => return Err(Fault::Damaged { at: began as u64, what: "a line that is no frame" }),
        }
    }
    let mut log = gather.log(Format::Can)?;
    for group in &mut log.groups {
        let message = messages.values().find(|message| message.name == group.name);
        for channel in &mut group.channels {
            channel.unit = message.and_then(|message| message.unit(&channel.name));
        }
    }
    log.torn_at = torn_at;
    let shown = |id: &u32| format!("frames {:X}: the description has no such message", id & !EXTENDED);
    log.passed_over = unknown.iter().take(MOST_NAMED).map(shown).collect();
    Ok(log)
}

/// Adds a frame's signals as a row of its message.
fn add(
    gather: &mut Gather,
    groups: &mut HashMap<u32, usize>,
    frame: &Frame,
    message: &Description<'_>,
) -> Result<(), Fault> {
    let group = match groups.get(&frame.id) {
        Some(group) => *group,
        None => gather.group(message.name)?,
    };
    groups.insert(frame.id, group);
    gather.row(group, frame.stamp_s)?;
    for (name, value) in message.values(&frame.bytes) {
        gather.set(group, name, &Value::Number(value))?;
    }
    Ok(())
}

/// A line of `candump -L`, such as `(1436509052.249713) can0 044#2A366C2BBA`, or of `candump -ta`; `None` is no
/// frame.
fn candump_frame(line: &str) -> Option<Line> {
    let (stamp, rest) = line.strip_prefix('(')?.split_once(')')?;
    let stamp_s = stamp.parse::<f64>().ok().filter(|stamp| stamp.is_finite())?;
    let mut words = rest.split_whitespace();
    let (_bus, frame) = (words.next()?, words.next()?);
    let (id, digits) = if let Some((id, data)) = frame.split_once('#') {
        // A second `#` and a digit of flags: CAN FD.
        (id, data.strip_prefix('#').map_or(data, |data| data.get(1..).unwrap_or_default()).to_owned())
    } else {
        words.next()?.strip_prefix('[')?;
        (frame, words.take_while(|word| word.len() == 2).collect())
    };
    let number = u32::from_str_radix(id, 16).ok()?;
    let id = if id.len() > 3 { number | EXTENDED } else { number };
    if digits.starts_with('R') || number > 0x1FFF_FFFF {
        return Some(Line::NoData);
    }
    let bytes = hexadecimal(&digits)?;
    Some(Line::Frame(Frame { stamp_s, id, bytes }))
}

/// A line of SavvyCAN's CSV: `166064000,0000021A,false,Rx,0,8,FE,36,12,FE,69,05,07,AD,`.
fn savvycan_frame(line: &str) -> Option<Line> {
    let mut fields = line.split(',').map(str::trim);
    let stamp_us = fields.next()?.parse::<f64>().ok().filter(|stamp| stamp.is_finite())?;
    let number = u32::from_str_radix(fields.next()?, 16).ok()?;
    let extended = fields.next()?.eq_ignore_ascii_case("true");
    let id = if extended { number | EXTENDED } else { number };
    let (_direction, _bus) = (fields.next()?, fields.next()?);
    let length: usize = fields.next()?.parse().ok()?;
    let digits: String = fields.by_ref().take(length.min(MAX_BYTES)).collect();
    let bytes = hexadecimal(&digits).filter(|bytes| bytes.len() == length)?;
    Some(Line::Frame(Frame { stamp_s: stamp_us / 1e6, id, bytes }))
}

/// Bytes of pairs of digits; `None` where they are no pairs, or too many.
fn hexadecimal(digits: &str) -> Option<Vec<u8>> {
    let digit = |byte: &u8| char::from(*byte).to_digit(16).map(|digit| digit as u8);
    let pairs = digits.as_bytes().chunks(2);
    let bytes: Vec<u8> =
        pairs.map(|pair| Some(digit(pair.first()?)? << 4 | digit(pair.get(1)?)?)).collect::<Option<_>>()?;
    (bytes.len() <= MAX_BYTES).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Position and velocity of an ODrive as floats. Then a current as a signed number of 12 bits of the other byte order,
    /// which is there only where the first byte is 2.
    const DBC: &str = r#"VERSION ""

NS_ :

BS_:

BU_: drive

BO_ 9 encoder: 8 drive
 SG_ position : 0|32@1- (1,0) [0|0] "rev" Vector__XXX
 SG_ velocity : 32|32@1- (1,0) [0|0] "rev/s" Vector__XXX

BO_ 2147483922 current: 3 drive
 SG_ page M : 0|8@1+ (1,0) [0|0] "" Vector__XXX
 SG_ iq m2 : 11|12@0- (0.5,1) [0|0] "A" Vector__XXX

SIG_VALTYPE_ 9 position : 1;
SIG_VALTYPE_ 9 velocity : 1;
"#;

    fn numbers(log: &Log, name: &str) -> Vec<f64> {
        log.find(name).unwrap_or_else(|| panic!("{name}")).1.values.numbers().unwrap().to_vec()
    }

    #[test]
    fn both_forms_and_both_orders_of_bytes_are_read() {
        let dbc = Dbc::try_from(DBC).unwrap();
        // 1.5 and −2; page 2 with −3, so that iq = −0.5; page 1.
        let candump = "(1700000000.000500) can0 009#0000C03F000000C0\n(1700000000.001000) can0 00000112#020FFD\n\
                       (1700000000.001500) can0 00000112#010FFD\n(1700000000.002000) can0 123#00\n\
                       (1700000000.002500) can0 009#R\n";
        let log = read(candump.as_bytes(), Some(&dbc)).unwrap();
        assert_eq!((numbers(&log, "encoder/position"), numbers(&log, "encoder/velocity")), (vec![1.5], vec![-2.0]));
        let iq = numbers(&log, "current/iq");
        assert!(iq[0] == -0.5 && iq[1].is_nan(), "{iq:?}");
        assert_eq!(log.find("encoder/position").unwrap().1.unit.as_deref(), Some("rev"));
        assert_eq!(log.passed_over, ["frames 123: the description has no such message"]);
        assert_eq!(log.groups[0].stamps_s.as_deref(), Some(&[1_700_000_000.000_5][..]));
        let savvycan = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n\
                        500,00000009,false,Rx,0,8,00,00,C0,3F,00,00,00,C0,\n1000,00000112,true,Rx,0,3,02,0F,FD,\n";
        let same = read(savvycan.as_bytes(), Some(&dbc)).unwrap();
        assert_eq!((numbers(&same, "encoder/position"), numbers(&same, "current/iq")), (vec![1.5], vec![-0.5]));
        let wide = " (1700000000.0005)  can0  009   [8]  00 00 C0 3F 00 00 00 C0   '...?....'\n";
        assert_eq!(numbers(&read(wide.as_bytes(), Some(&dbc)).unwrap(), "position"), [1.5]);
    }

    /// A log or a description with any byte changed is read or refused, and every channel has its rows.
    #[test]
    fn damaged_frames_and_descriptions_are_read_or_refused() {
        let log = "(1.000500) can0 009#0000C03F000000C0\n(1.001000) can0 00000112#020FFD\n";
        let mut read_at_all = 0;
        let changed = |text: &str, at: usize, byte: u8| {
            let mut bytes = text.as_bytes().to_vec();
            bytes[at] = byte;
            bytes
        };
        let dbc = Dbc::try_from(DBC).unwrap();
        let logs = (0..log.len()).flat_map(|at| b"\0\n#(9R\xff".map(|byte| (changed(log, at, byte), None)));
        let described = (0..DBC.len()).flat_map(|at| {
            b"\0 9-|".map(|byte| String::from_utf8(changed(DBC, at, byte)).ok()).into_iter().flatten().filter_map(
                |text| {
                    let dbc = super::super::guard::guarded(|| Dbc::try_from(text.as_str()).ok()).flatten()?;
                    Some((log.as_bytes().to_vec(), Some(dbc)))
                },
            )
        });
        for (bytes, other) in logs.chain(described) {
            if let Ok(log) = read(&bytes, Some(other.as_ref().unwrap_or(&dbc))) {
                read_at_all += 1;
                assert!(log.groups.iter().all(|group| group.channels.iter().all(|c| c.values.len() == group.rows())));
            }
        }
        assert!(read_at_all > 100, "{read_at_all}");
    }

    #[test]
    fn a_line_that_is_no_frame_is_refused_and_the_last_one_left_out() {
        let dbc = Dbc::try_from(DBC).unwrap();
        let good = "(1.0) can0 009#0000C03F000000C0\n";
        let torn = read(format!("{good}(1.1) can0 009#000").as_bytes(), Some(&dbc)).unwrap();
        assert_eq!(torn.torn_at, Some(good.len() as u64));
        for bad in ["(1.1) can0 009#0G\n", "(x) can0 009#00\n", "hello\n"] {
            let fault = read(format!("{good}{bad}{good}").as_bytes(), Some(&dbc)).unwrap_err();
            assert!(matches!(fault, Fault::Damaged { at, .. } if at == good.len() as u64), "{bad}");
        }
        // A frame shorter than its description has the signals that it holds wholly.
        let short = read(b"(1.0) can0 009#0000C03F00\n", Some(&dbc)).unwrap();
        assert!(short.find("position").is_some() && short.find("velocity").is_none());
        assert!(matches!(read(good.as_bytes(), None), Err(Fault::Unsupported { .. })));
    }
}
