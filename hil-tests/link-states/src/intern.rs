//! Values known by a number: states are compared and stored as numbers, and what follows from them is worked out once.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, PoisonError, RwLock};

/// The number of a value.
pub type Id = u32;

/// Values and their numbers; equal ones have the same.
#[derive(Debug)]
pub struct Interned<T>(RwLock<Known<T>>);

#[derive(Debug)]
struct Known<T> {
    ids: HashMap<Arc<T>, Id>,
    values: Vec<Arc<T>>,
}

impl<T> Default for Interned<T> {
    fn default() -> Self {
        Interned(RwLock::new(Known { ids: HashMap::new(), values: Vec::new() }))
    }
}

impl<T: Eq + Hash> Interned<T> {
    /// The number of a value.
    pub fn id(&self, value: T) -> Id {
        if let Some(&id) = self.0.read().unwrap_or_else(PoisonError::into_inner).ids.get(&value) {
            return id;
        }
        let mut known = self.0.write().unwrap_or_else(PoisonError::into_inner);
        let Known { ids, values } = &mut *known;
        let value = Arc::new(value);
        *ids.entry(Arc::clone(&value)).or_insert_with(|| {
            values.push(value);
            values.len() as Id - 1
        })
    }

    /// The value with a number that [`Interned::id`] has given.
    #[must_use]
    pub fn value(&self, id: Id) -> Arc<T> {
        Arc::clone(&self.0.read().unwrap_or_else(PoisonError::into_inner).values[id as usize])
    }

    /// How many values there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.read().unwrap_or_else(PoisonError::into_inner).values.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What follows from a key, worked out once.
#[derive(Debug)]
pub struct Worked<K, V>(RwLock<HashMap<K, V>>);

impl<K, V> Default for Worked<K, V> {
    fn default() -> Self {
        Worked(RwLock::new(HashMap::new()))
    }
}

impl<K: Eq + Hash + Copy, V: Clone> Worked<K, V> {
    /// What follows from this key.
    pub fn out(&self, key: K, work: impl FnOnce() -> V) -> V {
        if let Some(value) = self.0.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return value.clone();
        }
        let value = work();
        self.0.write().unwrap_or_else(PoisonError::into_inner).insert(key, value.clone());
        value
    }
}
