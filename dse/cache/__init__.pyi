from .digests import stamp as stamp
from .entries import (
    CacheWarning as CacheWarning,
    is_damaged as is_damaged,
    keep_content as keep_content,
    keep_file as keep_file,
    keep_files as keep_files,
    keep_folder as keep_folder,
    keep_living_folder as keep_living_folder,
    put_file as put_file,
    read_entry as read_entry,
    recent_entries as recent_entries,
    replace_file as replace_file,
    tell_damage as tell_damage,
    try_to_put as try_to_put,
    vouch as vouch,
)
from .folder import cache_folder as cache_folder, content_key as content_key
from .maintenance import (
    SECTIONS as SECTIONS,
    CacheSection as CacheSection,
    Entry as Entry,
    damaged as damaged,
    left_overs as left_overs,
    survey as survey,
    take_out as take_out,
    unused as unused,
)
from .plain_data import keep as keep, kept as kept
