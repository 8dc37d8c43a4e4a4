//! The store on a NOR flash.

use core::future::Future;
use core::ops::Range;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use breakaway_core::link::{FaultCause, Model, Settings};
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Loaded, Store, StoreError, VERSION};

const SETTINGS: u8 = 1;
const MODEL: u8 = 2;
const GENERATION: u8 = 3;
/// Longest item: a model with all its effects, and the key, version and generation before it.
const ITEM: usize = 320;
/// Version and generation in front of an item.
const HEAD: usize = 6;

/// Settings and model in at least two erase pages of a flash.
pub struct FlashStore<F: NorFlash> {
    map: MapStorage<u8, F, Cache<Uncached, Uncached, Uncached, u8>>,
    range: Range<u32>,
    generation: u32,
    /// Something of what is kept could not be used: it counts no more.
    spoilt: bool,
}

/// Why an item cannot be used: the version found, −1 if unreadable.
struct Lost(i32);

impl<F: NorFlash> FlashStore<F> {
    /// In `range` of `flash`; `None` unless that is at least two whole erase pages.
    pub fn new(flash: F, range: Range<u32>) -> Option<Self> {
        let config = MapConfig::try_new(range.clone()).ok()?;
        Some(Self { map: MapStorage::new(flash, config, Cache::new_uncached()), range, generation: 0, spoilt: false })
    }

    /// Reads what is kept; where that cannot be used, `defaults` and what was lost.
    #[inline(never)]
    pub fn load(&mut self, defaults: Settings) -> Loaded {
        let loaded = self.read(defaults);
        self.spoilt = loaded.lost.is_some();
        loaded
    }

    fn read(&mut self, defaults: Settings) -> Loaded {
        if self.blank() {
            return Loaded::defaults(defaults);
        }
        let lost = |cause, Lost(found)| Loaded { lost: Some((cause, found)), ..Loaded::defaults(defaults) };
        match self.item::<u32>(GENERATION, None) {
            Ok(generation) => self.generation = generation,
            Err(error) => return lost(FaultCause::SettingsLost, error),
        }
        let settings = self.item::<Settings>(SETTINGS, Some(self.generation));
        let settings = match settings.and_then(|found| found.validate().map(|()| found).map_err(|_| Lost(-1))) {
            Ok(settings) => settings,
            Err(error) => return lost(FaultCause::SettingsLost, error),
        };
        let model = self.item::<Option<Model>>(MODEL, Some(self.generation));
        let usable = |model: &Option<Model>| model.as_ref().is_none_or(|model| model.validate().is_ok());
        match model {
            Ok(model) if usable(&model) => Loaded { settings, model, lost: None },
            Ok(_) => Loaded { settings, ..lost(FaultCause::ModelLost, Lost(-1)) },
            Err(error) => Loaded { settings, ..lost(FaultCause::ModelLost, error) },
        }
    }

    /// Whether nothing was ever written. What cannot be read is not blank.
    #[inline(never)]
    fn blank(&mut self) -> bool {
        let mut bytes = [0; 64];
        let mut at = self.range.start;
        while at < self.range.end {
            let part = bytes.len().min((self.range.end - at) as usize);
            let Some(part) = bytes.get_mut(..part) else {
                return false;
            };
            if wait(self.map.flash().read(at, part)).is_err() || part.iter().any(|byte| *byte != 0xff) {
                return false;
            }
            at += part.len() as u32;
        }
        true
    }

    fn item<T: DeserializeOwned>(&mut self, key: u8, generation: Option<u32>) -> Result<T, Lost> {
        let mut buffer = [0; ITEM];
        match postcard::take_from_bytes(self.fetch(&mut buffer, key, generation)?) {
            Ok((value, [])) => Ok(value),
            _ => Err(Lost(-1)),
        }
    }

    /// What is stored under a key, behind its head. One copy for all types.
    #[inline(never)]
    fn fetch<'b>(&mut self, buffer: &'b mut [u8; ITEM], key: u8, generation: Option<u32>) -> Result<&'b [u8], Lost> {
        let found = wait(self.map.fetch_item::<&[u8]>(buffer, &key));
        let Ok(Some(bytes)) = found else {
            return Err(Lost(-1));
        };
        let Some(([v0, v1, g0, g1, g2, g3], content)) = bytes.split_first_chunk::<HEAD>() else {
            return Err(Lost(-1));
        };
        let version = u16::from_le_bytes([*v0, *v1]);
        if version != VERSION {
            return Err(Lost(i32::from(version)));
        }
        if generation.is_some_and(|wanted| wanted != u32::from_le_bytes([*g0, *g1, *g2, *g3])) {
            return Err(Lost(-1));
        }
        Ok(content)
    }

    fn put<T: Serialize>(&mut self, key: u8, value: &T, generation: u32) -> Result<(), StoreError> {
        let mut item = [0; ITEM];
        let (_, content) = item.split_first_chunk_mut::<HEAD>().ok_or(StoreError)?;
        let used = HEAD + postcard::to_slice(value, content).map_err(|_| StoreError)?.len();
        self.store(key, &mut item, used, generation)
    }

    /// Writes the head, and the item of `used` bytes.
    #[inline(never)]
    fn store(&mut self, key: u8, item: &mut [u8; ITEM], used: usize, generation: u32) -> Result<(), StoreError> {
        let (head, _) = item.split_first_chunk_mut::<HEAD>().ok_or(StoreError)?;
        let [v0, v1] = VERSION.to_le_bytes();
        let [g0, g1, g2, g3] = generation.to_le_bytes();
        *head = [v0, v1, g0, g1, g2, g3];
        let bytes = item.get(..used).ok_or(StoreError)?;
        let mut buffer = [0; ITEM + 16];
        wait(self.map.store_item(&mut buffer, &key, &bytes)).map_err(|_| StoreError)
    }
}

impl<F: NorFlash> Store for FlashStore<F> {
    #[inline(never)]
    fn save(&mut self, settings: &Settings, model: Option<&Model>) -> Result<(), StoreError> {
        if self.spoilt {
            // Items of an older generation would pass for those of this one: the last number is not known.
            wait(self.map.erase_all()).map_err(|_| StoreError)?;
        }
        let generation = self.generation.wrapping_add(1);
        self.put(SETTINGS, settings, generation)?;
        self.put(MODEL, &model, generation)?;
        self.put(GENERATION, &generation, generation)?;
        self.generation = generation;
        // On cells that are not as erased as they look a write ends well and something else stands there.
        let kept = self.read(*settings);
        self.spoilt = kept.lost.is_some();
        let same =
            !self.spoilt && self.generation == generation && kept.settings == *settings && kept.model.as_ref() == model;
        if same { Ok(()) } else { Err(StoreError) }
    }
}

/// Runs a future of a flash that blocks: it is ready when first asked. One that is not is asked again.
fn wait<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return value;
        }
    }
}
