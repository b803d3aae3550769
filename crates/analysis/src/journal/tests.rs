//! What is kept where.

use super::*;

/// One that keeps small things.
#[derive(Default)]
struct Small(Mutex<BTreeMap<String, Vec<u8>>>);

impl Journal for Small {
    fn get(&self, key: &str) -> Option<Vec<u8>> {
        self.0.lock().unwrap().get(key).cloned()
    }

    fn put(&self, key: &str, content: &[u8]) {
        if content.len() < 3 {
            self.0.lock().unwrap().insert(key.into(), content.to_vec());
        }
    }
}

#[test]
fn what_is_kept_elsewhere_is_not_kept_in_memory_too() {
    let elsewhere = Small::default();
    let recent = Recent::new(&elsewhere);
    recent.put("small", &[1, 2]);
    recent.put("large", &[1, 2, 3]);
    assert_eq!(recent.kept().keys().collect::<Vec<_>>(), ["large"]);
    assert_eq!((recent.get("small"), recent.get("large")), (Some(vec![1, 2]), Some(vec![1, 2, 3])));
    let alone = Recent::new(&NoJournal);
    alone.put("small", &[1]);
    assert_eq!(alone.get("small"), Some(vec![1]));
}
